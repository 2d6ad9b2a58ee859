#!/bin/bash
# What a tier of accuracy costs in exactness: members of a study that spreads its designs, at one
# tier and at another.
#   bench_draft.sh STUDY.json OUT.json [MEMBERS] [TIER] [REFERENCE]
# 12 members at draft and at standard unless given, with the recorded pressures of the study, one
# solver at a time. For each: angle and tip at the last pressure both ways; over all: median and worst
# relative error of the angle, and of the distance between the tips as a part of the length.
# Needs jq; BIN: where the programs are.
set -eu
study=$1 out=$2 members=${3:-12} tier=${4:-draft} reference=${5:-standard}
BIN=${BIN:-$PWD}
command -v jq > /dev/null || { echo "bench_draft: jq is not installed"; exit 0; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1

"$BIN/pneulab-solve" --embed "$study" > "$work/study.json"
for accuracy in "$tier" "$reference"; do
  jq -c --argjson members "$members" --arg accuracy "$accuracy" \
    '.size = $members | .set["/accuracy"] = $accuracy | .set["/timeout"] = "1 h"' "$work/study.json" > "$work/$accuracy.json"
  "$BIN/pneulab-solve" --jobs 1 "$work/$accuracy.json" > "$work/$accuracy.out"
done

jq -n --arg tier "$tier" --arg reference "$reference" --slurpfile draft "$work/$tier.out" \
  --slurpfile standard "$work/$reference.out" --slurpfile study "$work/study.json" '
  def final: { status, angle_deg: .metrics.bending_angle_deg, tip_mm: (.samples[-1] | [.tip_x_mm, .tip_z_mm]) };
  def median: sort | if length % 2 == 1 then .[length / 2 | floor] else (.[length / 2 - 1] + .[length / 2]) / 2 end;
  ($study[0].base.actuator.length | split(" ")[0] | tonumber) as $length
  | [$draft[0].members, $standard[0].members] | transpose
  | map({ name: .[0].name, coarse: (.[0] | final), fine: (.[1] | final) }) as $all
  | [$all[] | select(.coarse.status == "succeeded" and .fine.status == "succeeded")
    | . + { angle_error: (.coarse.angle_deg / .fine.angle_deg - 1),
        tip_error: (([.coarse.tip_mm, .fine.tip_mm] | transpose | map(.[0] - .[1] | . * .) | add | sqrt) / $length) }]
  | { program: "bench_draft", tier: $tier, reference: $reference, members: ($all | length), compared: length,
      angle_error_median: (map(.angle_error | fabs) | median), angle_error_mean: (map(.angle_error) | add / length),
      angle_error_worst: (map(.angle_error | fabs) | max),
      tip_error_median: (map(.tip_error) | median), tip_error_worst: (map(.tip_error) | max), designs: . }' > "$out"
jq -r '"\(.compared) of \(.members) designs, \(.tier) against \(.reference): angle \(.angle_error_median * 1e4 | round / 100) % " +
  "in the median, \(.angle_error_worst * 1e4 | round / 100) % at worst; tip \(.tip_error_median * 1e4 | round / 100) % of the " +
  "length, \(.tip_error_worst * 1e4 | round / 100) %"' "$out"
