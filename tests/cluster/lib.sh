# shellcheck shell=bash
# Shared by the tests of the executor `slurm`: that of tests/api, with a throw-away cluster.
# Source it; what it starts ends with the test.
HERE=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
. "$HERE/../api/lib.sh"
CLUSTER=$WORK/cluster
export SLURM_CONF=$CLUSTER/slurm.conf

end_of_test() {
  if [ "$FAILED" -ne 0 ]; then
    echo "the cluster's log:"; tail -n 60 "$CLUSTER/log/slurmctld"
  fi
  if [ -n "$DAEMON_PID" ]; then
    kill -KILL "$DAEMON_PID"
    wait "$DAEMON_PID" 2> /dev/null
    DAEMON_PID=
  fi
  "$HERE/cluster_down.sh" --kill "$CLUSTER"
  cleanup
}
trap end_of_test EXIT
: > "$WORK/stderr"
"$HERE/cluster_up.sh" "$CLUSTER" || exit

# The shadow memory of a sanitizer does not fit under a limit of private memory.
limit=2048
grep -aqE '__(asan|tsan)_init' "$BIN/pneulab-solve" && limit=0

# start_on_cluster OPTION...: the daemon, its jobs go to the cluster.
start_on_cluster() {
  start_daemon --executor slurm --memory-limit "$limit" "$@"
}

# wait_for SECONDS COMMAND...: until the command prints something other than nothing or 0; prints it.
wait_for() {
  local found='' end=$((SECONDS + $1))
  shift
  while [ "$SECONDS" -le "$end" ]; do
    found=$("$@")
    [ -n "$found" ] && [ "$found" != 0 ] && break
    sleep 0.1
  done
  printf '%s' "$found"
}

# gone PID: says so when the process has ended.
gone() {
  [ "$(alive "$1")" = yes ] || echo gone
}

# tasks_are COUNT: prints it when so many tasks wait or run.
tasks_are() {
  local count
  count=$(squeue -h -r -t pending,running,completing -o %i | wc -l)
  [ "$count" = "$1" ] && echo "$count"
}

# milliseconds: of a clock.
milliseconds() {
  date +%s%3N
}
