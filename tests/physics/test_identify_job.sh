#!/bin/bash
# jobs/beast/identify-20A-0.25.json: its table is what make_trials makes of the preset, and the preset's
# coefficients, guards and resets come out of it. Needs jq.
set -u
source=${srcdir:-.}
command -v jq > /dev/null || { echo "SKIP: jq is not installed"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() {
  echo "FAILED: $1"
  exit 1
}

tests/physics/make_trials "$source/jobs/beast/20A-0.25.json" 1 0.01 > "$work/table.csv" ||
  fail "make_trials"
cmp "$work/table.csv" "$source/jobs/beast/20A-0.25-synthetic.csv" || fail "the table is another one"
./pneulab-solve "$source/jobs/beast/identify-20A-0.25.json" > "$work/result.json" || fail "the job"

# within KEY MODE INDEX TRUTH: a coefficient within 3 % of the truth.
within() {
  jq -e --arg mode "$2" "[.modes[] | select(.name == \$mode).polynomials.$1.coefficients[$3]] | .[0] |
    (.value - $4) | (if . < 0 then -. else . end) <= 0.03 * ($4 | if . < 0 then -. else . end)" \
    "$work/result.json" > /dev/null || fail "$1[$3] of the $2 mode: $(jq -c \
    "[.modes[].polynomials.$1.coefficients[$3].value]" "$work/result.json"), not $4"
}
number() {
  jq -r "$1 | split(\" \")[0]" "$source/jobs/beast/20A-0.25.json"
}
for mode in compressed stretched; do
  within damping_N_s_m $mode 0 "$(number ".model.modes.$mode.damping")"
  within alpha_1_s $mode 0 "$(number ".model.modes.$mode.alpha")"
  within beta_1_s $mode 0 "$(number ".model.modes.$mode.beta")"
done
within stiffness_N_m compressed 0 "$(number .model.modes.compressed.stiffness.coefficients[0])"
within stiffness_N_m compressed 1 "$(number .model.modes.compressed.stiffness.coefficients[1])"
within stiffness_N_m stretched 0 "$(number .model.modes.stretched.stiffness)"
jq -e '.transitions | length == 2 and
    (.[0].level_mm | .low <= 14.06 and 14.06 <= .high and .high - .low < 1) and
    (.[1].level_mm | .low <= 27 and 27 <= .high and .high - .low < 1) and
    (.[0].reset | (.h_mm | .low <= 44.7 and 44.7 <= .high) and
       (.velocity_m_s | .low <= 0.1067 and 0.1067 <= .high) and
       (.pressure_kPa | .low <= 38.61 and 38.61 <= .high))' "$work/result.json" > /dev/null ||
  fail "guards and resets: $(jq -c .transitions "$work/result.json")"
jq -e '.metrics | .held_out_trials == 12 and .held_out_nrmse_h < 0.012 and
    .held_out_nrmse_pressure < 0.012 and .held_out_r_squared_h > 0.99' "$work/result.json" \
  > /dev/null || fail "trials that are held out: $(jq -c .metrics "$work/result.json")"
# The model goes into an hlpv job as it is.
jq '{ kind: "hlpv", model, initial: { mode: "compressed" },
      input: { hold: [["0 s", "3 psi"], ["5 s", "6 psi"], ["10 s", "-3 psi"]] }, end: "15 s" }' \
  "$work/result.json" | ./pneulab-solve - | jq -e '.status == "succeeded" and
    [.events[].to] == ["stretched", "compressed"]' > /dev/null || fail "the model as a job"
jq -c .metrics "$work/result.json"
