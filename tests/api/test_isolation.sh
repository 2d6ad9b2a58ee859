#!/bin/bash
# Workers that do what they must not: each is stopped, and nothing of them is left.
. "$(dirname "$0")/lib.sh"
CONFINED=1 # for start_daemon
export CONFINED
export PNEULAB_SECRET=secret
HOSTILE=$BIN/tests/api/hostile_solver
REPOSITORY=$(cd "$(dirname "$0")/../.." && pwd)
launch=$BIN/pneulab-launch
read_probe() { "$launch" --probe | sed -n "s/^$1=//p"; }
namespaces=$(read_probe namespaces) processes=$(read_probe processes)
landlock=$(read_probe landlock) seccomp=$(read_probe seccomp)

# misbehave NAME [SECONDS]: runs a job of that name; FACTS gets what its worker found out.
misbehave() {
  fetch POST /api/v1/jobs -H "Prefer: wait=${2:-30}" --data-binary "$(job ".name = \"$1\"")"
  ID=$(field .id)
  FACTS=$(curl -s "$URL/api/v1/jobs/$ID/metrics" | jq -c .metrics)
}

# fact NAME: errno or number.
fact() {
  printf '%s' "$FACTS" | jq ".$1"
}

# left TAG: processes with this mark in their environment.
left() {
  grep -lzs "^DETACHED=$1\$" /proc/[0-9]*/environ | wc -l
}

start_daemon --workers 2 --retry-delay 0 --memory-limit 256 --files-limit 16 --solver "$HOSTILE"
cp "$WORK/stderr" "$WORK/first"
check_match "the log says what holds" "isolation of workers: " "$(cat "$WORK/stderr")"

misbehave "trespass $DAEMON_PID"
check "the worker came to its end" succeeded "$(field .state)"
check "its own folder is writable" 0 "$(fact write_own)"
check "the environment is cleaned" 2 "$(fact environment_kept)"
check "no descriptor is inherited" 0 "$(fact inherited_descriptors)"
for limit in raise_memory raise_files limits_of_daemon mount unshare_net kexec chroot; do
  check_match "$limit is refused" '^(1|3)$' "$(fact $limit)"
done
check "root's file is not readable" 13 "$(fact read_shadow)"
if [ "$landlock" -gt 0 ]; then
  for file in write_tmp write_data write_attempts read_passwd read_database truncate_database \
    delete_database; do
    check "Landlock refuses $file" 13 "$(fact $file)"
  done
  check_match "memory of the daemon" '^(2|13)$' "$(fact memory_of_daemon)"
  check_match "environment of the daemon" '^(2|13)$' "$(fact environment_of_daemon)"
  check_match "the log says so" 'landlock [1-9]' "$(cat "$WORK/first")"
else
  echo "this kernel has no Landlock: files of others are not checked"
  check_match "the log says so" 'not on this kernel: .*landlock' "$(cat "$WORK/first")"
fi
if [ "$seccomp" -gt 0 ]; then
  for call in socket_inet socket_inet6 socket_unix socket_netlink io_uring unshare_user clone_user \
    bpf keyctl memfd symlink fifo; do
    check "seccomp refuses $call" 1 "$(fact $call)"
  done
  check_match "the log says so" 'seccomp \(no network\)' "$(cat "$WORK/first")"
else
  echo "this kernel has no seccomp filters: system calls are not checked"
  check_match "the log says so" 'not on this kernel: .*seccomp' "$(cat "$WORK/first")"
fi
if [ "$namespaces" -gt 0 ] || [ "$landlock" -ge 6 ]; then
  check_match "the daemon cannot be signalled" '^(1|3)$' "$(fact signal_daemon)"
fi
check "nothing was written outside" "" "$(ls -d /tmp/pneulab-escaped "$DATA"/escaped "$DATA"/attempts/99-1 2> /dev/null)"
check "the database is intact" ok "$(sql 'pragma integrity_check')"

# Memory, shared memory, files, processes.
misbehave hoard
check_match "memory ends at the limit" '^(2[0-4][0-9]|25[0-6])$' "$(fact memory_MB)"
misbehave "hoard shared"
check "shared memory ends too" true "$([ "$(fact memory_MB)" -lt 1800 ] && echo true)"
misbehave "big file"
check "a file ends at its limit" 27 "$(fact big_file)"
misbehave "many files"
check "and all files together" "failed files_limit" "$(field '.state + " " + .reason_code')"
if [ "$processes" -gt 0 ]; then
  misbehave bomb
  check "a fork bomb ends" true "$([ "$(fact processes)" -lt 400 ] && echo true)"
else
  check_match "the log says so" 'not on this kernel: .*number of processes' "$(cat "$WORK/first")"
fi
sleep 0.2
check "nothing of it is left" 0 "$(pgrep -fc "^$HOSTILE")"

# What forks, opens a session of its own and lets go of everything.
misbehave "detach 1"
check "a worker that leaves a process behind" succeeded "$(field .state)"
check "it is gone with its worker" 0 "$(left 'detach 1')"
ID=$(submit "$(job '.name = "detach 2 and wait"')")
wait_state "$ID" running > /dev/null
sleep 0.3
check "one that runs on" 1 "$(left 'detach 2 and wait')"
curl -s -X POST -H 'Prefer: wait=10' "$URL/api/v1/jobs/$ID/cancel" | jq -r .state > "$WORK/state"
check "cancelled" cancelled "$(cat "$WORK/state")"
check "it is gone with its worker" 0 "$(left 'detach 2 and wait')"
"$launch" --write "$WORK" "$HOSTILE" --out "$WORK" <(job '.name = "detach 3"') > /dev/null
check "without a namespace the launcher finds it" 0 "$(left 'detach 3')"
ID=$(submit "$(job '.name = "detach 4 and wait"')")
wait_state "$ID" running > /dev/null
sleep 0.3
check "another one" 1 "$(left 'detach 4 and wait')"

# One that does not hear SIGTERM, and a daemon that is killed.
deaf=$(submit "$(job '.name = "deaf"')")
wait_state "$deaf" running > /dev/null
start=$SECONDS
curl -s -X POST -H 'Prefer: wait=20' "$URL/api/v1/jobs/$deaf/cancel" | jq -r .state > "$WORK/state"
check "SIGTERM is not all there is" "cancelled true" \
  "$(cat "$WORK/state") $([ $((SECONDS - start)) -le 8 ] && echo true)"
stop_daemon KILL
sleep 0.3
check "with the daemon everything ends" "0 0" "$(left 'detach 4 and wait') $(pgrep -fc "^$HOSTILE")"

# A real job, with all of it.
limit=2048
# The shadow memory of a sanitizer does not fit under a limit of private memory.
grep -aqE '__(asan|tsan)_init' "$BIN/pneulab-solve" && limit=0
start_daemon --workers 2 --memory-limit $limit
fetch POST /api/v1/jobs -H 'Prefer: wait=60' --data-binary @"$REPOSITORY/jobs/beast/20A-0.18.json"
check "a real job runs" succeeded "$(field .state)"
stop_daemon TERM
if [ "$namespaces$processes$seccomp" = 111 ] && [ "$landlock" -gt 0 ]; then
  start_daemon --isolation require --memory-limit $limit
  stop_daemon TERM
fi
"$BIN/pneulabd" --data "$DATA" --listen 127.0.0.1:0 --launcher /nonexistent 2> "$WORK/second"
check "no launcher" 1 $?
check_match "its reason" "There is no program /nonexistent" "$(cat "$WORK/second")"
finish
