#!/bin/bash
# From a geometry to a hybrid model, on a coarse mesh: the motion triggers where the path has its
# limit point, and the derived job, which is simulated, rests where the path does. Needs jq.
set -u
source=${srcdir:-.}
solve=${BIN:-.}/pneulab-solve
command -v jq > /dev/null || { echo "SKIP: jq is not installed"; exit 77; }
grep -aqE '__(asan|tsan)_init' "$solve" && { echo "SKIP: finite elements take long with sanitizers"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0
passed=0

# holds WHAT CONDITION, of jq, about the result of the snap job ($hlpv: that of the derived job).
holds() {
  if jq -e --slurpfile hlpv "$work/hlpv.json" "$2" "$work/snap.json" > /dev/null; then
    passed=$((passed + 1))
  else
    failed=$((failed + 1))
    echo "FAILED: $1: $(jq -c '.status, .message, .metrics, .hybrid, .warnings' "$work/snap.json")"
  fi
}

jq '.accuracy = "fast" | .load.law = ["-40 kPa", "0 kPa", "20 kPa", "40 kPa", "60 kPa"]' \
  "$source/jobs/beast/snap-20A-0.25-dynamics.json" > "$work/job.json"
"$solve" "$work/job.json" > "$work/snap.json"
jq .hlpv "$work/snap.json" > "$work/derived.json"
"$solve" "$work/derived.json" > "$work/hlpv.json"

holds "the paths are found" '.status == "succeeded" and (.law | length) == 5'
holds "forces and volumes of the law agree (Maxwell) to 2 %" '.motion.laws[0].volume_difference_pct < 2'
holds "three pairs snap, at the speed that is published or some way from it" \
  '.metrics.snap_count == 3 and .metrics.snap_speed_m_s > 0.75 and .metrics.snap_speed_m_s < 3'
holds "the weakest pair triggers at its factor times the limit point" \
  '(.metrics.dynamic_trigger_pressure_kPa / .metrics.trigger_pressure_kPa / 0.97 - 1 | fabs) < 0.01'
holds "the trigger of the hybrid model is the limit point" \
  '(.hybrid.trigger_kPa / .metrics.trigger_pressure_kPa - 1 | fabs) < 0.01'
holds "energies balance" '.metrics.energy_balance_error_mJ < 0.01'
holds "the derived job succeeds with one switch" \
  '$hlpv[0].status == "succeeded" and $hlpv[0].metrics.event_count == 1'

# The states of rest of the derived job against three times the path of one pair, in parts of the travel.
between='def between($p; $points): [$points[] | [.pressure_kPa, .h_mm]] | . as $q
  | [range(1; length) | select($q[. - 1][0] <= $p and $q[.][0] > $p)] | .[0] as $i
  | $q[$i - 1][1] + ($p - $q[$i - 1][0]) / ($q[$i][0] - $q[$i - 1][0]) * ($q[$i][1] - $q[$i - 1][1]);
  def path($name): [.paths[] | select(.name == $name)][0].points | map(select(.stable));'
holds "compressed states of rest within 1.5 % of the travel" "$between"'
  path("pressure") as $path | .metrics.travel_mm as $travel
  | [$hlpv[0].holds[] | select(.mode == "compressed" and .set_point_kPa > 1)
     | (.steady_h_mm - 3 * between(.set_point_kPa; $path)) / (3 * $travel) | fabs] | length >= 3 and max < 0.015'
holds "stretched ones, too" "$between"'
  path("pressure from natural") as $path | .metrics.travel_mm as $travel
  | [$hlpv[0].holds[] | select(.mode == "stretched" and .set_point_kPa > 1 and .set_point_kPa < 59)
     | (.steady_h_mm - 3 * between(.set_point_kPa; $path)) / (3 * $travel) | fabs] | length >= 3 and max < 0.015'
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
