#!/bin/bash
# The stream of events: order, filters, resumption, restarts of the daemon, limits, its end.
. "$(dirname "$0")/lib.sh"
quick=$(solver 'progress 0.25 12.5; sleep 0.4; progress 0.75 37.5; sleep 0.4; result succeeded')

# follow FILE [QUERY] [CURL OPTION...]: listens in the background; FOLLOWER is its process.
follow() {
  local file=$1 query=${2:-}
  shift 2
  curl -sN -D "$file.head" "$@" "$URL/api/v1/events$query" > "$file" &
  FOLLOWER=$!
  for _ in $(seq 100); do
    if [ -s "$file" ]; then break; fi
    sleep 0.02
  done
}
# wait_text FILE PATTERN: until a line matches.
wait_text() {
  for _ in $(seq 200); do
    if grep -Eq -- "$2" "$1"; then return 0; fi
    sleep 0.05
  done
  return 1
}
# ids FILE: the ids of its state events; states FILE: "job state" of each.
ids() { awk '/^id: /{id = $2} /^event: state/{print id}' "$1" | tr '\n' ' '; }
states() { grep -A1 '^event: state' "$1" | sed -n 's/^data: //p' | jq -r '"\(.job) \(.state)"'; }
history() { sql "select id from event where id > ${1:-0} ${2:-} order by id" | tr '\n' ' '; }

start_daemon --workers 2 --subscribers 4 --solver "$quick"
follow "$WORK/all" ''
all=$FOLLOWER
first=$(submit "$(job '.labels = { suite: "api", batch: "a" }')")
second=$(submit "$(job '.labels = { suite: "api", batch: "b" }')")
follow "$WORK/one" "?job=$second&after=0"
one=$FOLLOWER
follow "$WORK/label" '?label.suite=api&label.batch=a&after=0'
label=$FOLLOWER
wait_text "$WORK/all" "\"job\":$second,.*progress|\"job\":$second,.*fraction\":0.25" || true
fetch GET "/api/v1/jobs/$second"
check_match "a running job tells what was reported" '^\{"fraction":0\.[27]5,"pressure_kPa":(12|37)\.5,"step":null,"steps":null,"iteration":null,"eta_s":(null|[0-9.]+)\}$' "$(field .progress_detail)"
wait_state "$first" succeeded > /dev/null
wait_state "$second" succeeded > /dev/null
wait_text "$WORK/one" '"succeeded"'
wait_text "$WORK/label" '"succeeded"'
wait_text "$WORK/all" "\"job\":$second,\"state\":\"succeeded\""

check "the type of the stream" 'text/event-stream' "$(tr -d '\r' < "$WORK/all.head" | sed -n 's/^Content-Type: //p')"
check "its first lines" 'retry: 2000 id: 0 ' "$(head -2 "$WORK/all" | tr '\n' ' ')"
check "every change, in order" "$(history)" "$(ids "$WORK/all")"
check "one job's states" "$second queued,$second starting,$second running,$second succeeded" "$(states "$WORK/one" | paste -sd,)"
check "one label's states" "$first queued,$first starting,$first running,$first succeeded" "$(states "$WORK/label" | paste -sd,)"
check "progress of one job, each report once" '0.25 12.5,0.75 37.5' \
  "$(grep -A1 '^event: progress' "$WORK/one" | sed -n 's/^data: //p' | jq -r '"\(.fraction) \(.pressure_kPa)"' | paste -sd,)"
check "the time left is estimated" true "$(grep -A1 '^event: progress' "$WORK/one" | sed -n 's/^data: //p' | tail -1 | jq '.eta_s >= 0 and .eta_s < 5')"
check "progress has no id" 0 "$(grep -B1 '^event: progress' "$WORK/all" | grep -c '^id:')"

# Resumption, by header and by query; the header wins.
follow "$WORK/resumed" '?after=1' -H 'Last-Event-ID: 3'
wait_text "$WORK/resumed" "\"job\":$second,\"state\":\"succeeded\""
check "from the middle" "$(history 3)" "$(ids "$WORK/resumed")"
check_match "a fifth client is refused" '^503 overloaded 10$' "$(fetch GET /api/v1/events; echo "$CODE $(field .code) $(header Retry-After)")"
check "other requests are not" 200 "$(fetch GET "/api/v1/jobs/$first"; echo "$CODE")"
kill "$FOLLOWER" "$label"
wait "$FOLLOWER" "$label" 2> /dev/null

for _ in $(seq 40); do # those who left are noticed without anything being sent
  fetch HEAD /api/v1/events --head
  if [ "$CODE" = 200 ]; then break; fi
  sleep 0.1
done

# HEAD ends, and leaves no subscriber behind.
check "HEAD" '200 text/event-stream' "$(curl -sI "$URL/api/v1/events" | tr -d '\r' | awk '/^HTTP/{s = $2} /^Content-Type/{t = $2} END{print s, t}')"
for bad in job=x job=1,1 'job=' after=-1 after=x since=3 "$(seq -f 'label.x%g=1' -s '&' 17)" 'label.a=1&job=x'; do
  fetch GET "/api/v1/events?$bad"
  check "?$bad" '400 invalid_query' "$CODE $(field .code)"
done
for bad in x -1 17x '17 18' 99999999999999999999; do
  fetch GET /api/v1/events -H "Last-Event-ID: $bad"
  check "Last-Event-ID: $bad" '400 invalid_header' "$CODE $(field .code)"
done
check "an empty Last-Event-ID is none" 200 "$(curl -sI -H 'Last-Event-ID;' -o /dev/null -w '%{http_code}' "$URL/api/v1/events")"

# A restart with events before, in and after it: the streams end cleanly, nothing is lost.
third=$(submit)
wait_text "$WORK/all" "\"job\":$third,\"state\":\"running\""
fourth=$(submit)
fifth=$(submit)
since=$SECONDS
stop_daemon TERM
wait "$all"
check "the stream ends whole" 0 $?
wait "$one"
check "a filtered stream too" 0 $?
check "the end is not waited for" true "$([ $((SECONDS - since)) -le 5 ] && echo true)"
check "the end tells what happened last" "$(history)" "$(ids "$WORK/all")"
last=$(awk '/^id: /{id = $2} END{print id}' "$WORK/all")
sqlite3 "$DATA/pneulab.db" "insert into event (at_ms, job_id, state) select 1, 999, 'deleted' from generate_series(1, 3)"
start_daemon --workers 2 --solver "$quick"
follow "$WORK/again" '' -H "Last-Event-ID: $last"
wait_state "$fourth" succeeded > /dev/null
wait_state "$fifth" succeeded > /dev/null
curl -s -X DELETE "$URL/api/v1/jobs/$third"
wait_text "$WORK/again" "\"job\":$third,\"state\":\"deleted\""
check "after a restart: the rest" "$(history "$last")" "$(ids "$WORK/again")"

# More events than are kept in memory, to a client that starts from the beginning.
sqlite3 "$DATA/pneulab.db" "insert into event (at_ms, job_id, state) select 1, value, 'deleted' from generate_series(1000, 5000)"
last=$(submit)
wait_state "$last" succeeded > /dev/null
follow "$WORK/old" '?after=0'
wait_text "$WORK/old" "\"job\":$last,\"state\":\"succeeded\""
check "from the beginning: everything" "$(history | md5sum)" "$(ids "$WORK/old" | md5sum)"
follow "$WORK/few" "?after=0&job=$last"
wait_text "$WORK/few" '"succeeded"'
check "from the beginning, filtered" "$(history 0 "and job_id = $last")" "$(ids "$WORK/few")"
finish
