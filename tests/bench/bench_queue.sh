#!/bin/bash
# Simulations of a hybrid model as one study through the daemon's queue.
#   bench_queue.sh JOB.json OUT.json [MEMBERS]
# The job's model is taken through eight steps of 1 psi, 5 s each, at a tolerance of 1e-9; mass and
# damping vary, MEMBERS times (10000 unless given, a square). One worker, which solves one member
# at a time. Times: of the POST; from its answer until the study has succeeded; of the page of its job,
# its result and a plot after that. CPU time: of all members' attempts, and of the daemon until then.
# Needs curl, jq, sqlite3; BIN: where the programs are.
set -eu
job=$1 out=$2 members=${3:-10000}
BIN=${BIN:-$PWD}
for tool in curl jq sqlite3; do
  command -v $tool > /dev/null || { echo "bench_queue: $tool is not installed"; exit 0; }
done
work=$(mktemp -d)
daemon=
cleanup() {
  if [ -n "$daemon" ]; then kill "$daemon" 2> /dev/null || true; wait "$daemon" 2> /dev/null || true; fi
  rm -rf "$work"
}
trap cleanup EXIT
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1

jq -c --argjson members "$members" '($members | sqrt | floor) as $side
  | .input = { hold: [range(8) | ["\(5 * .) s", "\(. + 1) psi"]] } | .end = "40 s" | .tolerance = 1e-9
  | .sample_rate = "1 Hz"
  | del(.comment)
  | { kind: "study", name: "\($side * $side) simulations", base: ., sampling: "grid", timeout: "30 min",
      parameters: [
        { pointer: "/model/mass", name: "mass", values: [range($side) | "\(40 + 0.4 * .) g"] },
        { pointer: "/model/modes/stretched/damping", name: "damping",
          values: [range($side) | "\(10 + 0.1 * .) N s/m"] } ] }' "$job" > "$work/study.json"

"$BIN/pneulabd" --data "$work/data" --listen 127.0.0.1:0 --solver "$BIN/pneulab-solve" \
  --workers 1 > "$work/stdout" 2> "$work/stderr" &
daemon=$!
for _ in $(seq 200); do
  grep -q '^listening on ' "$work/stdout" && break
  sleep 0.05
done
url=$(sed -n 's/^listening on //p' "$work/stdout")
now() { date +%s.%N; }

post_s=$(curl -sf -o "$work/answer" -w '%{time_total}' -H 'Content-Type: application/json' \
  --data-binary "@$work/study.json" "$url/api/v1/jobs")
id=$(jq .id "$work/answer")
from=$(now)
while :; do
  state=$(sqlite3 -readonly -cmd '.timeout 5000' "$work/data/pneulab.db" "select state from job where id = $id")
  case $state in succeeded | failed | timed_out | cancelled) break ;; esac
  sleep 0.2
done
to=$(now)
ticks=$(getconf CLK_TCK)
daemon_cpu_s=$(sed 's/.*) //' "/proc/$daemon/stat" | awk -v ticks="$ticks" '{ print ($12 + $13) / ticks }')
[ "$state" = succeeded ] || { echo "bench_queue: the study is $state"; exit 1; }
timed() { curl -sf -o "$work/part" -w '%{time_total}' "$url/api/v1/jobs/$id$1"; }
page_s=$(timed '')
result_s=$(timed /result)
bytes=$(stat -c %s "$work/part")
jq -c .metrics "$work/part" > "$work/metrics"
plot_s=$(timed /plots/metric.png)
of_members() { sqlite3 -readonly "$work/data/pneulab.db" "select $1 from job join attempt on job_id = job.id where study_id = $id"; }
cpu_s=$(of_members 'total(cpu_s)')
memory=$(of_members 'max(peak_memory_MB)')
daemon_kB=$(awk '/VmHWM/ { print $2 }' "/proc/$daemon/status")
jq -n --slurpfile metrics "$work/metrics" --argjson post "$post_s" --argjson from "$from" --argjson to "$to" \
  --argjson cpu "$cpu_s" --argjson daemon_cpu "$daemon_cpu_s" --argjson memory "$memory" --argjson page "$page_s" --argjson result "$result_s" \
  --argjson plot "$plot_s" --argjson bytes "$bytes" --argjson daemon "$daemon_kB" '
  $metrics[0].solved as $solved
  | { program: "bench_queue", members: $metrics[0].designs, solved: $solved, post_s: $post, wall_s: ($to - $from),
      cpu_s: $cpu, daemon_cpu_s: $daemon_cpu, simulations_per_minute_wall: (60 * $solved / ($post + $to - $from)),
      simulations_per_minute_core: (60 * $solved / ($cpu + $daemon_cpu)),
      solver_peak_memory_MB: $memory, daemon_peak_memory_MB: ($daemon / 1000), result_bytes: $bytes,
      page_s: $page, result_s: $result, plot_s: $plot }' > "$out"
jq -r '"\(.solved) of \(.members) simulations: \(.wall_s * 100 | round / 100) s, \(.cpu_s * 100 | round / 100) s of solvers, " +
  "\(.daemon_cpu_s * 100 | round / 100) s of the daemon; " +
  "\(.simulations_per_minute_wall | round) a minute, \(.simulations_per_minute_core | round) a minute of a core"' "$out"
