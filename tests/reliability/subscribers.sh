#!/bin/bash
# Many clients follow the events while jobs come and go: none misses one, the memory of the daemon
# stays small, other requests are answered as if nobody followed.
#   subscribers.sh [COUNT [SECONDS]]     default 1000 for 600 s
. "$(dirname "$0")/../api/lib.sh"
count=${1:-1000} seconds=${2:-600}
sanitized=no
if ldd "$BIN/pneulabd" | grep -Eq 'lib[at]san'; then sanitized=yes; fi
probe() { "$BIN/tests/bench/load_probe" 127.0.0.1 "$PORT" "/api/v1/jobs/$first" 8 50 "$1"; }
memory_MB() { awk '/VmHWM/ { printf "%d", $2 / 1024 }' "/proc/$DAEMON_PID/status"; }

start_daemon --workers 2 --connections-per-address $((count + 100)) --subscribers "$count" \
  --solver "$(solver 'progress 0.3 15; sleep 0.2; progress 0.6 30; sleep 0.1; result succeeded')"
first=$(submit)
wait_state "$first" succeeded > /dev/null
# produce SECONDS: a few jobs all the time, now and then many at once.
produce() {
  local end=$((SECONDS + $1)) number=0
  while [ "$SECONDS" -lt "$end" ]; do
    number=$((number + 1))
    if [ $((number % 50)) -eq 10 ]; then
      for _ in $(seq 40); do submit > /dev/null; done
    else
      submit > /dev/null
    fi
    sleep 0.2
  done
}
while_alone=$((seconds / 20 + 2))
probe "$while_alone" > "$WORK/alone" &
prober=$!
produce "$while_alone"
wait "$prober"

"$BIN/tests/bench/load_subscribe" 127.0.0.1 "$PORT" "$count" $((seconds + 60)) > "$WORK/followers" \
  2> "$WORK/ready" &
followers=$!
for _ in $(seq 300); do
  if [ -s "$WORK/ready" ]; then break; fi
  sleep 0.1
done
probe "$seconds" > "$WORK/probe" &
prober=$!
produce "$seconds"
wait "$prober"
alone=$(cat "$WORK/alone")
following=$(cat "$WORK/probe")
memory=$(memory_MB)
stop_daemon TERM
wait "$followers"
told=$(cat "$WORK/followers")
last=$(sql 'select max(id) from event')

say() { printf '%-56s %s\n' "$1" "$2"; }
say "subscribers" "$count for $seconds s"
say "events each" "$(jq ".events / $count | floor" <<< "$told")"
say "reports of progress each" "$(jq ".reports / $count | round" <<< "$told")"
say "largest memory of the daemon" "$memory MB"
say "other requests, nobody following: p50, p99, max in ms" "$(jq -r '"\(.p50_ms) \(.p99_ms) \(.max_ms)"' <<< "$alone")"
say "other requests meanwhile" "$(jq -r '"\(.p50_ms) \(.p99_ms) \(.max_ms)"' <<< "$following")"

check "every client was let in, and every stream ended whole" "$count $count 0" \
  "$(jq -r '"\(.opened) \(.ended) \(.broken)"' <<< "$told")"
check "from the id that opens a stream on, none was left out or came twice" 0 "$(jq .gaps <<< "$told")"
check "all came to the last event" "$last $last" "$(jq -r '"\(.last_least) \(.last_greatest)"' <<< "$told")"
check "progress was told" true "$(jq ".reports >= $count" <<< "$told")"
check "every other request was answered" 0 "$(jq .failed <<< "$following")"
if [ "$sanitized" = no ]; then
  check "the memory of the daemon stays under 64 MB" true "$([ "$memory" -lt 64 ] && echo true)"
fi
if [ "$seconds" -ge 60 ]; then # on a machine that does nothing else
  check "99 of 100 other requests take less than 100 ms" true "$(jq '.p99_ms < 100' <<< "$following")"
fi
finish
