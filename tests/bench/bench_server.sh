#!/bin/bash
# Rates and latencies of the daemon, each beside the least that its libraries need in the same run.
#   bench_server.sh OUT.json
# SECONDS_EACH: of every measurement (default 5). BIN: where the programs are. Needs curl, jq, wrk.
# Figures of a machine that does something else mean nothing; the ratios suffer least.
set -eu
out=$1
BIN=${BIN:-$PWD}
here=$(cd "$(dirname "$0")" && pwd)
each=${SECONDS_EACH:-5}
for tool in curl jq wrk; do
  command -v $tool > /dev/null || { echo "bench_server: $tool is not installed"; exit 1; }
done
work=$(mktemp -d)
pids=()
cleanup() {
  for pid in "${pids[@]}"; do
    kill "$pid" 2> /dev/null || true
    wait "$pid" 2> /dev/null || true
  done
  rm -rf "$work"
}
trap cleanup EXIT
export OPENBLAS_NUM_THREADS=1

jq -n '{ kind: "response", name: "twelve chambers", labels: { suite: "bench" },
  actuator: { family: "pneunet", length: "118 mm", width: "30 mm", height: "15.6 mm",
    chambers: [{ config: "B", count: 12 }], chamber_gap: "2 mm", side_wall: "2 mm", top_wall: "1.5 mm",
    bottom_layer: "6 mm", channel: { width: "4 mm", height: "2 mm" } },
  material: "elastic-50a", load: { pressure: { to: "50 kPa", steps: 2 } },
  contact: false, accuracy: "fast" }' > "$work/job.json"
printf '#!/bin/sh\nexec sleep 100000\n' > "$work/sleeper"
chmod +x "$work/sleeper"

# daemon NAME OPTION...: starts one; its address in url, its process in daemon.
daemon() {
  local name=$1
  shift
  "$BIN/pneulabd" --data "$work/$name" --listen 127.0.0.1:0 --request-rate 0 "$@" > "$work/$name.out" \
    2> "$work/$name.log" &
  daemon=$!
  pids+=("$daemon")
  for _ in $(seq 200); do
    grep -q '^listening on ' "$work/$name.out" && break
    sleep 0.05
  done
  url=$(sed -n 's/^listening on //p' "$work/$name.out")
}
stop() {
  kill "$1"
  wait "$1" || true
}
submit() { curl -sf --data-binary "@$1" "$url/api/v1/jobs" | jq .id; }
state() { curl -sf "$url/api/v1/jobs/$1" | jq -r .state; }
# load CONNECTIONS URL [SCRIPT]: requests a second and p99 in ms by wrk, as JSON.
load() {
  wrk -t1 "-c$1" "-d$each" --latency ${3:+-s "$3"} "$2" > "$work/wrk"
  awk '/^ +99%/ { p99 = $2; f = p99 ~ /us$/ ? 0.001 : p99 ~ /ms$/ ? 1 : 1000; sub(/[a-z]+$/, "", p99); p99 *= f }
    /^Requests\/sec/ { rate = $2 } /Non-2xx/ { bad = $NF }
    END { printf "{\"per_s\":%.1f,\"p99_ms\":%.3f,\"refused\":%d}\n", rate, p99, bad }' "$work/wrk"
}
say() { printf '%s\n' "$*" >&2; }

# ---- reading a job: the daemon and a bare libmicrohttpd, one after the other, three times each
daemon read --workers "$(nproc)" --connections-per-address 1000
id=$(submit "$work/job.json")
until [ "$(state "$id")" = succeeded ]; do sleep 0.1; done
curl -sf -D "$work/head" -o "$work/body" "$url/api/v1/jobs/$id"
mkfifo "$work/hold"
"$BIN/tests/bench/bare_http" 8 "$work/head" "$work/body" < "$work/hold" > "$work/bare.out" &
pids+=($!)
exec 9> "$work/hold"
until [ -s "$work/bare.out" ]; do sleep 0.05; done
bare=http://127.0.0.1:$(cat "$work/bare.out")
: > "$work/reads"
for _ in 1 2 3; do
  jq -nc --argjson daemon "$(load 32 "$url/api/v1/jobs/$id")" \
    --argjson bare "$(load 32 "$bare/api/v1/jobs/$id")" '{ $daemon, $bare }' >> "$work/reads"
done
exec 9>&-
say "GET of a job, 32 connections: $(jq -rs 'map(.daemon.per_s / .bare.per_s * 100 | round | tostring) | join(", ")' "$work/reads") % of bare libmicrohttpd"

# ---- the same while every core solves
jq '.accuracy = "fine" | .contact = true | .load.pressure.steps = 50' "$work/job.json" > "$work/long.json"
running=()
for _ in $(seq "$(nproc)"); do running+=("$(submit "$work/long.json")"); done
for other in "${running[@]}"; do
  until [ "$(state "$other")" = running ]; do sleep 0.05; done
done
sleep 1
busy=$(load 32 "$url/api/v1/jobs/$id")
still=0
for other in "${running[@]}"; do
  if [ "$(state "$other")" = running ]; then still=$((still + 1)); fi
  curl -sf -X POST "$url/api/v1/jobs/$other/cancel" > /dev/null || true
done
stop "$daemon"
say "the same with $still cores solving: $(jq -r '"\(.per_s | round)/s, p99 \(.p99_ms) ms"' <<< "$busy")"

# ---- durable submissions beside single rows of SQLite on the same disk
daemon post --workers 1 --connections-per-address 1000 --solver "$work/sleeper"
submit "$work/job.json" > /dev/null
export POST_DOCUMENT=$work/job.json
: > "$work/posts"
number=0
for clients in 1 8 32; do
  number=$((number + 1))
  before=$("$BIN/tests/bench/bare_sqlite" "$work/raw$number-a.db" "$work/job.json" "$each")
  post=$(load "$clients" "$url/api/v1/jobs" "$here/post.lua")
  after=$("$BIN/tests/bench/bare_sqlite" "$work/raw$number-b.db" "$work/job.json" "$each")
  jq -nc --argjson clients "$clients" --argjson post "$post" --argjson before "$before" --argjson after "$after" \
    '{ $clients, $post, raw_per_s: (($before + $after) / 2) } | .ratio = .post.per_s / .raw_per_s' >> "$work/posts"
done
stop "$daemon"
say "durable POSTs against SQLite rows: $(jq -rs 'map("\(.clients) clients \(.post.per_s | round)/s, \(.ratio * 100 | round) %") | join("; ")' "$work/posts")"

# ---- 150 clients that trickle their header, and a normal load from another address
: > "$work/trickles"
for case in "one address, 20 allowed:20:" "one address, 400 allowed:400:" "150 addresses:20:127.1.0.0"; do
  IFS=: read -r name allowed from <<< "$case"
  daemon "trickle$allowed$from" --workers 1 --connections-per-address "$allowed"
  port=${url##*:}
  id=$(submit "$work/job.json")
  until [ "$(state "$id")" = succeeded ]; do sleep 0.1; done
  # shellcheck disable=SC2086 # no address, no argument
  "$BIN/tests/bench/load_trickle" 127.0.0.1 "$port" 150 12 ${from:-127.0.1.1 one} > "$work/trickle" &
  trickler=$!
  sleep 0.5
  probe=$("$BIN/tests/bench/load_probe" 127.0.0.1 "$port" "/api/v1/jobs/$id" 8 200 9)
  wait "$trickler"
  jq -nc --arg name "$name" --argjson load "$probe" --slurpfile trickle "$work/trickle" \
    '{ $name, trickle: $trickle[0], load: $load }' >> "$work/trickles"
  stop "$daemon"
done
say "150 tricklers: $(jq -rs 'map("\(.name): \(.trickle.closed) closed within \(.trickle.last_closed_s) s, load p99 \(.load.p99_ms) ms") | join("; ")' "$work/trickles")"

jq -n --slurpfile reads "$work/reads" --argjson busy "$busy" --argjson cores "$still" --slurpfile posts "$work/posts" \
  --slurpfile trickles "$work/trickles" '{ program: "bench_server", reads: $reads,
  read_ratio: ($reads | map(.daemon.per_s / .bare.per_s) | sort | .[1]), busy: ($busy + { cores: $cores }), posts: $posts,
  trickles: $trickles }' > "$out"
jq -e '[(.read_ratio >= 0.6), (.busy.p99_ms < 20), (.posts | all(.ratio >= 0.25)),
  (.trickles | all(.load.p99_ms < 100 and .load.failed == 0 and .trickle.closed == 150 and .trickle.last_closed_s <= 10))]
  | . as $held | ["reading", "reading while solving", "submitting", "tricklers"] | to_entries
  | map("\(.value): \(if $held[.key] then "as wanted" else "NOT as wanted" end)") | join("\n")' -r "$out"
