#!/bin/bash
# The daemon is killed again and again at any moment: every job it acknowledged ends with one result.
. "$(dirname "$0")/lib.sh"
SOLVER=$(solver 'sleep 0.0$((RANDOM % 9)); result succeeded')
ROUNDS=${ROUNDS:-8}
for _ in $(seq "$ROUNDS"); do
  start_daemon --workers 4 --retry-delay 0 --solver "$SOLVER"
  clients=()
  for client in 1 2 3 4; do
    for _ in $(seq 20); do
      id=$(submit "$(job)" -m 5 2> /dev/null) && [ -n "$id" ] && echo "$id" || break
    done >> "$WORK/acknowledged.$client" &
    clients+=($!)
  done
  sleep "0.$((RANDOM % 5 + 2))"
  stop_daemon KILL
  wait "${clients[@]}"
done
start_daemon --workers 4 --retry-delay 0 --solver "$SOLVER"
jobs=$(sql 'select count(*) from job')
for _ in $(seq 600); do
  [ "$(sql "select count(*) from job where state = 'succeeded'")" = "$jobs" ] && break
  sleep 0.1
done
sort -n "$WORK"/acknowledged.* > "$WORK/acknowledged"
check_match "some jobs were acknowledged" '^[1-9]' "$(wc -l < "$WORK/acknowledged")"
check "none of them is missing" "" "$(sql 'select id from job' | sort | comm -13 - <(sort "$WORK/acknowledged"))"
check "no id was given twice" "" "$(uniq -d "$WORK/acknowledged")"
check "all jobs succeeded" "$jobs" "$(sql "select count(*) from job where state = 'succeeded'")"
check "one result each" "$jobs" "$(sql 'select count(*) from result')"
check "from the last attempt" 0 "$(sql 'select count(*) from result join job on job.id = job_id where result.attempt <> job.attempt')"
check "no attempt is open" 0 "$(sql "select count(*) from attempt where outcome = ''")"
check "the database is intact" ok "$(sql 'pragma integrity_check; select * from pragma_foreign_key_check' | paste -sd' ')"
finish
