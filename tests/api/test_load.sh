#!/bin/bash
# Many clients at once: readers, submitters who wait, cancellers, deleters, plots.
. "$(dirname "$0")/lib.sh"
start_daemon --workers 4 --retry-delay 0.1 --solver "$(solver 'progress 0.5 25; result succeeded')"
seed=$(submit)
wait_state "$seed" succeeded > /dev/null

clients=()
for i in 1 2 3; do # readers
  for _ in $(seq 20); do
    curl -s "$URL/api/v1/jobs?limit=5" "$URL/metrics" "$URL/api/v1/compare?jobs=$seed" \
      "$URL/api/v1/jobs/$seed/plots/angle.png" -o /dev/null -o /dev/null -o /dev/null -o /dev/null \
      -w '%{http_code}\n'
  done > "$WORK/read.$i" &
  clients+=($!)
done
for i in 1 2 3; do # submitters who wait for the end
  for _ in $(seq 10); do
    curl -s -H 'Prefer: wait=50' --data-binary "$(job)" "$URL/api/v1/jobs" | jq -r .state
  done > "$WORK/wait.$i" &
  clients+=($!)
done
for i in 1 2; do # cancellers and deleters, who may come too early or too late
  for _ in $(seq 10); do
    id=$(submit "$(job '.name = "doomed"')")
    curl -s -o /dev/null -w '%{http_code}\n' -X POST "$URL/api/v1/jobs/$id/cancel"
    wait_state "$id" 'succeeded|cancelled' > /dev/null
    curl -s -o /dev/null -w '%{http_code}\n' -X DELETE "$URL/api/v1/jobs/$id"
  done > "$WORK/cancel.$i" &
  clients+=($!)
done
for _ in $(seq 6); do # one key, many senders
  curl -s -H 'Idempotency-Key: same' --data-binary "$(job '.name = "same"')" "$URL/api/v1/jobs" > /dev/null &
  clients+=($!)
done
wait "${clients[@]}"

check "every reading was answered" "240 200" "$(cat "$WORK"/read.* | sort | uniq -c | awk '{ print $1, $2 }')"
check "every waiter saw the end" "30 succeeded" "$(cat "$WORK"/wait.* | sort | uniq -c | awk '{ print $1, $2 }')"
check "cancelled or too late, then deleted" "" "$(cat "$WORK"/cancel.* | grep -vE '^(200|202|409|204)$')"
check "all doomed jobs are gone" 0 "$(sql "select count(*) from job where name = 'doomed'")"
check "one key, one job" 1 "$(sql "select count(*) from job where name = 'same'")"
wait_state "$(sql "select id from job where name = 'same'")" succeeded > /dev/null
check "one result each" "32 32" "$(sql "select count(*) || ' ' || (select count(*) from result) from job where state = 'succeeded'")"
check "no files of deleted jobs" 32 "$(ls "$DATA/attempts" | wc -l)"
finish
