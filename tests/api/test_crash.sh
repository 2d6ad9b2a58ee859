#!/bin/bash
# Workers and daemons that are killed: nothing is lost, nothing counts twice.
. "$(dirname "$0")/lib.sh"
SOLVER=$(solver '
name=$(jq -r .name "$job")
echo "$name" >> "'"$WORK"'/starts"
case $name in
  slow) until [ -e "'"$WORK"'/go" ]; do sleep 0.05; done; result succeeded ;;
  sleepy) progress 0.1 1; exec sleep 60 ;;
  dies) kill -KILL $$ ;;
  once) [ -e "'"$WORK"'/died" ] || { touch "'"$WORK"'/died"; kill -KILL $$; }; result succeeded ;;
  internal) exit 4 ;;
  garbage) echo "no JSON" ;;
  hungry) exec tail /dev/zero ;;
  *) result succeeded ;;
esac')
start_daemon --workers 2 --retry-delay 0.1 --memory-limit 64 --solver "$SOLVER"

# Workers that die.
fetch POST /api/v1/jobs -H 'Prefer: wait=20' --data-binary "$(job '.name = "dies"')"
check "three attempts, then failed" "failed worker_killed 3" "$(field '.state + " " + .reason_code') $(field .attempt)"
id=$(field .id)
check "each attempt is on record" "1 worker_lost 9,2 worker_lost 9,3 worker_lost 9" \
  "$(sql "select number || ' ' || outcome || ' ' || signal from attempt where job_id = $id order by number" | paste -sd,)"
check "the way through the states" "queued starting running retry_wait starting running retry_wait starting running failed" \
  "$(sql "select state from event where job_id = $id order by id" | paste -sd' ')"
fetch POST /api/v1/jobs -H 'Prefer: wait=20' --data-binary "$(job '.name = "once"')"
check "one death is survived" "succeeded 2" "$(field .state) $(field .attempt)"
check "one result" 1 "$(sql "select count(*) from result where job_id = $(field .id)")"
fetch POST /api/v1/jobs -H 'Prefer: wait=20' --data-binary "$(job '.name = "internal"')"
check "internal error" "failed internal_error 3" "$(field '.state + " " + .reason_code') $(field .attempt)"
fetch POST /api/v1/jobs -H 'Prefer: wait=20' --data-binary "$(job '.name = "garbage"')"
check "output that is no result" "failed result_invalid 3" "$(field '.state + " " + .reason_code') $(field .attempt)"
fetch POST /api/v1/jobs -H 'Prefer: wait=30' --data-binary "$(job '.name = "hungry"')"
check "a worker over its memory limit is not tried again" "failed memory_limit 1" "$(field '.state + " " + .reason_code') $(field .attempt)"
fetch POST /api/v1/jobs -H 'Prefer: wait=20' --data-binary "$(job '.name = "sleepy"')" &
other=$!
for _ in $(seq 200); do
  worker=$(sql "select pid from attempt join job on job.id = job_id where name = 'sleepy' and state = 'running'")
  [ -n "$worker" ] && break
  sleep 0.05
done
sleepy=$(sql "select id from job where name = 'sleepy'")
kill -KILL "$worker"
check "a worker killed from outside is replaced" 2 \
  "$(for _ in $(seq 100); do n=$(sql "select attempt from job where id = $sleepy and state = 'running'"); [ "$n" = 2 ] && break; sleep 0.05; done; echo "$n")"
curl -s -X POST "$URL/api/v1/jobs/$sleepy/cancel" > /dev/null
wait $other

# The daemon is killed in the middle of jobs.
for _ in 1 2 3 4; do submit "$(job '.name = "slow"')" > /dev/null; done
sleepy=$(submit "$(job '.name = "sleepy"')")
ids=$(sql "select id from job where name = 'slow'")
wait_state "$(head -1 <<< "$ids")" running > /dev/null
sleep 0.3
open=$(sql "select count(*) from job where state = 'running'")
check "jobs were running" 2 "$open"
pids=$(sql "select pid from attempt where outcome = '' and pid is not null")
stop_daemon KILL
sleep 0.3
for pid in $pids; do
  check "worker $pid died with the daemon" no "$(alive "$pid")"
done
check "the database is intact" ok "$(sql 'pragma integrity_check')"
start_daemon --workers 2 --retry-delay 0.1 --memory-limit 64 --solver "$SOLVER"
touch "$WORK/go"
for id in $ids; do
  check "job $id runs again and succeeds" succeeded "$(wait_state "$id" 'succeeded|failed')"
done
check "exactly one result each" "1 1 1 1" "$(for id in $ids; do sql "select count(*) from result where job_id = $id"; done | paste -sd' ')"
check "the lost attempts are on record" "$open" "$(sql "select count(*) from attempt where outcome = 'lost' and job_id in (select id from job where name = 'slow')")"
check "results come from the last attempt" 0 "$(sql 'select count(*) from result join job on job.id = job_id where result.attempt <> job.attempt')"

# A second daemon on the same data is refused.
"$BIN/pneulabd" --data "$DATA" --listen 127.0.0.1:0 2> "$WORK/second"
check "second daemon" 4 $?
check_match "its reason" "another pneulabd" "$(cat "$WORK/second")"

# A cancelled job stays cancelled over a crash.
wait_state "$sleepy" running > /dev/null
curl -s -X POST "$URL/api/v1/jobs/$sleepy/cancel" > /dev/null &
for _ in $(seq 500); do # from then on it is a promise
  [ "$(sql "select state from job where id = $sleepy")" = running ] || break
done
stop_daemon KILL
wait
start_daemon --workers 2 --retry-delay 0.1 --solver "$SOLVER" --drain-timeout 2
check "cancelled" cancelled "$(wait_state "$sleepy" 'cancelled|running')"

# SIGTERM: what finishes in time is kept, the rest goes back into the queue.
rm "$WORK/go"
slow=$(submit "$(job '.name = "slow"')")
sleepy=$(submit "$(job '.name = "sleepy"')")
later=$(submit "$(job '.name = "later"')")
wait_state "$slow" running > /dev/null; wait_state "$sleepy" running > /dev/null
sleep 0.3
curl -s -o "$WORK/waiting" -H 'Prefer: wait=50' "$URL/api/v1/jobs/$sleepy" &
sleep 0.3
start=$SECONDS
kill -TERM "$DAEMON_PID"
sleep 0.3
touch "$WORK/go"
wait "$DAEMON_PID"
STATUS=$?
DAEMON_PID=
wait
check "exit status" 0 "$STATUS"
check "within the drain time and the workers' grace" true "$([ $((SECONDS - start)) -le 15 ] && echo true)"
check "the one that finished" succeeded "$(sql "select state from job where id = $slow")"
check "the one that did not" "queued daemon_stopped" "$(sql "select state || ' ' || reason_code from job where id = $sleepy")"
check "the one that waited" queued "$(sql "select state from job where id = $later")"
check "a waiting client got an answer" "$sleepy" "$(jq -r .id "$WORK/waiting")"
start_daemon --workers 2 --solver "$SOLVER"
check "it goes on" succeeded "$(wait_state "$later" succeeded)"
wait_state "$sleepy" running > /dev/null

# A second signal ends it at once.
start=$SECONDS
kill -TERM "$DAEMON_PID"
sleep 0.5
check_match "no new connections" "000" "$(curl -s -o /dev/null -w '%{http_code}' "$URL/healthz")"
stop_daemon TERM
check "second signal: at once" "0 true" "$STATUS $([ $((SECONDS - start)) -le 3 ] && echo true)"
check "still queued" queued "$(sql "select state from job where id = $sleepy")"
check "no attempt was left open" 0 "$(sql "select count(*) from attempt where outcome = ''")"

# A solver that is not there, and a data directory that cannot be made.
start_daemon --workers 1 --retry-delay 0.1 --solver /nonexistent/pneulab-solve --listen '[::1]:0'
curl -s -X POST "$URL/api/v1/jobs/$sleepy/cancel" > /dev/null
fetch POST /api/v1/jobs -H 'Prefer: wait=20' --data-binary "$(job)"
check "no solver" "failed worker_not_started 3" "$(field '.state + " " + .reason_code') $(field .attempt)"
check_match "the message names it" "/nonexistent/pneulab-solve" "$(field .message)"
check_match "IPv6" '^http://\[::1\]:' "$URL"
"$BIN/pneulabd" --data /dev/null/x --listen 127.0.0.1:0 2> "$WORK/second"
check "no data directory" 1 $?
check_match "its reason" "/dev/null" "$(cat "$WORK/second")"
"$BIN/pneulabd" --data "$WORK/other" --listen "127.0.0.1:99999" 2> "$WORK/second"
check "a port that is none" 2 $?
finish
