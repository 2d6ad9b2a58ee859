#!/bin/bash
# The jobs of jobs/beast about the motion of bistable actuators: all run, energies balance, and
# what symmetry and order demand. Needs jq.
set -u
source=${srcdir:-.}
command -v jq > /dev/null || { echo "SKIP: jq is not installed"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0
passed=0

# holds NAME WHAT CONDITION: the condition, of jq, about the result of the job.
holds() {
  if jq -e "$3" "$work/$1.json" > /dev/null; then passed=$((passed + 1)); else
    failed=$((failed + 1))
    echo "FAILED: $1: $2: $(jq -c '.status, .message, .metrics' "$work/$1.json")"
  fi
}

# metric NAME KEY
metric() {
  jq -r ".metrics.$2" "$work/$1.json"
}

# Finite elements take half a minute for a law, so that cubics are put in their place: 34.9 kPa make
# the thick one snap, 22.0 kPa the thin one.
rest='"per": "mm", "area": "8.1 cm2", "volume": "9 ml", "range": ["-3 mm", "14 mm"]'
thick="{$rest, \"coefficients\": [\"0 N\", \"33.1 N\", \"-11.27 N\", \"0.87 N\"]}"
thin="{$rest, \"coefficients\": [\"0 N\", \"20.9 N\", \"-7.10 N\", \"0.548 N\"]}"
closed="if .snap then del(.snap) | .laws = {snap: $thick} else .laws = {thick: $thick, thin: $thin} end"
for name in bistable-pair bistable-three-pairs bistable-two-lengths module-two-parallel push-power push-gentle; do
  jq "$closed" "$source/jobs/beast/$name.json" > "$work/job.json"
  "${BIN:-.}/pneulab-solve" "$work/job.json" > "$work/$name.json"
  holds $name "succeeds" '.status == "succeeded"'
  holds $name "energies balance to 0.1 %" '.metrics.energy_balance_error_mJ < 1e-3 * .metrics.peak_kinetic_mJ or .metrics.energy_balance_error_mJ < 0.02'
  holds $name "samples are in order" '[.samples[].time_s] | . == sort and length > 100'
done
holds bistable-pair "one snap, above the published 1.5 m/s as nothing limits the air" \
  '.metrics.snap_count == 1 and .metrics.snap_speed_m_s > 1.5 and .metrics.pressure_drop_kPa < 1'
holds bistable-three-pairs "the pressure falls with every snap" \
  '[.events[] | select(.type == "snap") | .least_pressure_kPa < .trigger_pressure_kPa - 3] | length == 3 and all'
holds bistable-two-lengths "a staircase: the thin pair, the thick one, the stiff one" \
  '[.events[] | select(.type == "snap") | .cell] == [1, 2, 3] and .metrics.return_count == 3'
holds bistable-two-lengths "lengths kept without pressure, one travel (8.45 mm) more each" \
  '[.plateaus[] | select(.start_s < 13)] | length >= 3 and all(.pressure_kPa | fabs < 0.5)
   and all((.h_mm - 8.45 * .stretched_cells | fabs) < 0.3)'
holds bistable-two-lengths "the steps are metrics" \
  '[.metrics | .plateau_1_mm, .plateau_2_mm, .plateau_3_mm] == [.plateaus[:3][].h_mm]'
holds module-two-parallel "both ways alike" \
  '.metrics | (.bending_angle_deg + .least_bending_angle_deg | fabs) < 0.01 and .bending_angle_deg > 10'
holds module-two-parallel "one alone stays stretched, so that it stays bent without pressure" \
  '.samples[] | select(.time_s == 3.4) | (.pressure_kPa | fabs) < 0.5 and .bending_angle_deg < -10'
holds module-two-parallel "with both it is straight and longer" \
  '[.samples[] | select(.time_s == 3.4 or .time_s == 7)] | (.[1].bending_angle_deg | fabs) < 1
   and .[1].h_mm > 1.5 * .[0].h_mm'
holds module-two-parallel "vacuum returns all" '.metrics | .snap_count == 12 and .return_count == 12'
awk -v a="$(metric push-power load_speed_m_s)" -v b="$(metric push-gentle load_speed_m_s)" \
  'BEGIN { exit !(a > 2 * b && b > 0) }' || { failed=$((failed + 1)); echo "FAILED: the power push is no faster"; }
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
