#!/bin/bash
# One small member of every job that `make reproduction` runs: few cells, one small step of pressure.
set -u
solve=$(pwd)/pneulab-solve
source=$(cd "${srcdir:-.}" && pwd)
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
command -v jq >/dev/null || { echo "SKIP: jq is not installed"; exit 77; }
fail() {
  echo "FAILED: $1"
  exit 1
}

small='def small: .load.pressure.steps = 1 | .error_estimate = false | .contact = false |
    .accuracy = "fast" | del(.measured) |
    (if .load.pressure.to then .load.pressure.to = "1 kPa"
     else .load.pressure.left |= (if . then "1 kPa" else . end) |
          .load.pressure.right |= (if . then "1 kPa" else . end) end) |
    (if .actuator.family == "pneunet" then . else .actuator.length = "70 mm" end) |
    (.mesh = {gap_wall: 1, cavity: 1, gap: 1, half_width: 1, side_wall: 1, bottom: 1, height: 1,
       top: 1}) | del(.metrics);
  if .kind == "study" then .base |= small | del(.ranking) |
    (if .set then .set |= with_entries(select(.key | test("^/(actuator|material)"))) else . end) |
    (if .designs then .designs |= .[0:1]
     elif .sampling == "optimise" then .budget = 1
     elif .size then .size = 1
     else .parameters |= map(.values |= .[0:1]) end) |
    (if .sampling == "one-at-a-time" then .parameters |= .[0:1] else . end) |
    (if .designs then .designs[0].set |= with_entries(select(.key | test("^/(actuator|material)")))
     else . end)
  elif .kind == "response" then small else . end'
count=0
for job in "$source"/jobs/{multicurvature,ptba,tapered,material}/*.json; do
  [ -e "$job" ] || continue
  "$solve" --embed "$job" >"$dir/embedded.json" || fail "$job is no job"
  jq -c "$small" "$dir/embedded.json" | "$solve" --jobs 1 - >"$dir/small.json" ||
    fail "a small member of $job: $(jq -c '[.reason, .message, .error]' "$dir/small.json")"
  jq -e '.status == "succeeded" and (.members // [] | all(.status == "succeeded"))' \
    "$dir/small.json" >/dev/null || fail "a small member of $job"
  count=$((count + 1))
done
echo "$count jobs"
