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

# Where a job has its law computed, that of another one, in closed form, is put in its place.
closed=$(jq -c '.laws' "$source/jobs/beast/push-power.json")
closed="if .snap then del(.snap) | .laws = {snap: $closed.pair} else . end"
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
holds bistable-two-lengths "a staircase up and down" \
  '.metrics.snap_count == 3 and .metrics.return_count == 3 and (.plateaus | length) >= 5
   and ([.plateaus[].stretched_cells] | max == 3)'
holds module-two-parallel "both ways alike" \
  '.metrics | (.bending_angle_deg + .least_bending_angle_deg | fabs) < 0.01 and .bending_angle_deg > 10'
holds module-two-parallel "together it does not bend" \
  '[.samples[] | select(.time_s < 4.9) | .bending_angle_deg | fabs] | max < 0.1'
awk -v a="$(metric push-power load_speed_m_s)" -v b="$(metric push-gentle load_speed_m_s)" \
  'BEGIN { exit !(a > 2 * b && b > 0) }' || { failed=$((failed + 1)); echo "FAILED: the power push is no faster"; }
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
