#!/bin/bash
# Fits of materials through the daemon with the real solver; files and bad tables are refused.
. "$(dirname "$0")/lib.sh"
source=$(cd "$(dirname "$0")/../.." && pwd)
limit=2048
# The shadow memory of a sanitizer does not fit under a limit of private memory.
grep -aqE '__(asan|tsan)_init' "$BIN/pneulab-solve" && limit=0
start_daemon --solver "$BIN/pneulab-solve" --memory-limit "$limit"
fit=$source/jobs/material/dragon-skin-20-100.json

"$BIN/pneulab-solve" --embed "$fit" > "$WORK/fit.json"
check "the job can be embedded" 0 "$?"
check "its table is there" true "$(jq '.data.csv | contains("Engineering Strain")' "$WORK/fit.json")"
fetch POST /api/v1/jobs:validate --data-binary "@$WORK/fit.json"
check "it is valid" true "$(field .valid)"
fetch POST /api/v1/jobs -H 'Prefer: wait=60' --data-binary "@$WORK/fit.json"
id=$(field .id)
check "it succeeds" succeeded "$(wait_state "$id" 'succeeded|failed|timed_out' 60)"
fetch GET "/api/v1/jobs/$id"
check "its kind" fit-material "$(field .kind)"
fetch GET "/api/v1/jobs/$id/metrics"
check "C1 within 2 % of 0.0612 MPa" true "$(field '.metrics.C1_MPa / 0.0612 - 1 | fabs < 0.02')"
check "C2 within 2 % of 0.00796 MPa" true "$(field '.metrics.C2_MPa / 0.00796 - 1 | fabs < 0.02')"
check "R2" true "$(field '.metrics.r_squared > 0.9975')"
check "with confidence intervals" true "$(field '.metrics.C1_MPa_error > 0')"
fetch GET "/api/v1/jobs/$id/result"
check "a sample a point" true "$(field '(.samples | length) == .metrics.points')"
check "of five numbers" 'band_MPa fitted_stress_MPa measured_stress_MPa strain stretch' \
  "$(field '.samples[0] | keys | join(" ")')"
check "stability of six deformations" 6 "$(field '.stability | length')"
check "the metric is a row of the database" 1 \
  "$(sql "select count(*) from metric where job_id = $id and name = 'C1_MPa' and value > 0.06")"
check "so are the samples" 43 \
  "$(sql "select count(*) from sample where job_id = $id and name = 'fitted_stress_MPa'")"
check "the table is no parameter" 0 \
  "$(sql "select count(*) from design_parameter where job_id = $id and pointer like '%csv'")"

# The material of the result is one for a job.
jq -c --argjson material "$(field .material)" '.material = $material' <<< "$(job)" > "$WORK/job.json"
fetch POST /api/v1/jobs:validate --data-binary "@$WORK/job.json"
check "the material can be used" true "$(field .valid)"

fetch POST /api/v1/jobs --data-binary "@$fit"
check "a file is refused" "422 /data/file" "$CODE $(field .pointer)"
check_match "with advice" 'pneulab-solve --embed' "$(field .detail)"

# changed EDIT: the job with another table.
changed() {
  jq -c "$1" "$WORK/fit.json"
}
# refused WHAT POINTER PATTERN DOCUMENT
refused() {
  fetch POST /api/v1/jobs --data-binary "$4"
  check "$1: status and pointer" "422 $2" "$CODE $(field .pointer)"
  check_match "$1: message" "$3" "$(field .detail)"
}
refused "text in the table" /data/csv 'line 20 of the table.*"oops" is not a number' \
  "$(changed '.data.csv |= sub("0.06795"; "oops")')"
refused "a gap" /data/csv 'line 20 of the table.*empty' \
  "$(changed '.data.csv |= sub("0.06795"; "")')"
refused "an unknown column" /columns/strain/name 'did you mean "Engineering Strain"' \
  "$(changed '.columns.strain.name = "Enginering Strain"')"
refused "exchanged columns" /columns/strain/name 'holds a stress, not a strain' \
  "$(changed '.columns = {strain: {name: "Engineering Stress (MPa)", unit: "1"}, stress: {name: "Engineering Strain", unit: "MPa"}}')"
refused "no rows" /data/csv 'no rows below its header' \
  "$(changed '.data.csv = "Engineering Strain,Engineering Stress (MPa)\n"')"

body='{"kind":"material-curve","name":"curve","material":"elastic-50a"}'
fetch POST /api/v1/jobs -H 'Prefer: wait=60' --data-binary "$body"
id=$(field .id)
check "the curves of a material" succeeded "$(wait_state "$id" 'succeeded|failed' 60)"
fetch GET "/api/v1/jobs/$id/result"
check "have their points" 101 "$(field '.samples | length')"
check_match "and say that it softens" 'equibiaxial tension from a stretch of 1.4' "$(field '.warnings | join(" ")')"
finish
