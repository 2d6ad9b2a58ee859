#!/bin/bash
# A verification through the daemon with the real solver: stored and drawn like any other job.
. "$(dirname "$0")/lib.sh"
limit=2048
# The shadow memory of a sanitizer does not fit under a limit of private memory.
grep -aqE '__(asan|tsan)_init' "$BIN/pneulab-solve" && limit=0
start_daemon --solver "$BIN/pneulab-solve" --memory-limit "$limit"

body='{"kind":"verify","name":"cylinder","case":"thick-cylinder-neo-hooke","refinement":2}'
fetch POST /api/v1/jobs:validate --data-binary "$body"
check "it is valid" true "$(field .valid)"
fetch POST /api/v1/jobs -H 'Prefer: wait=60' --data-binary "$body"
id=$(field .id)
check "it succeeds" succeeded "$(wait_state "$id" 'succeeded|failed|timed_out' 120)"
fetch GET "/api/v1/jobs/$id"
check "its kind" verify "$(field .kind)"
check "the error is a metric, below a thousandth" true "$(field '.metrics.error_percent < 0.1')"
fetch GET "/api/v1/jobs/$id/result"
check "one row a mesh" 2 "$(field '.meshes | length')"
check "a finer mesh errs less" true "$(field '.meshes[1].error_percent < .meshes[0].error_percent')"
check "four points of the curve" 4 "$(field '.samples | length')"
check "the reference has a source" "R. S. Rivlin 1949" \
  "$(field '.case.source | "\(.author) \(.year)"')"
check "points are rows of the database" 4 \
  "$(sql "select count(*) from sample where job_id = $id and name = 'inner_stretch'")"
check "so is the error" 1 \
  "$(sql "select count(*) from metric where job_id = $id and name = 'error_percent' and value < 0.1")"
fetch GET "/api/v1/jobs/$id"
check "two plots" 2 "$(field '.links.plots | length')"
for link in $(field '.links.plots[]'); do
  fetch GET "$link"
  check "GET $link" 200 "$CODE"
done
fetch GET "/api/v1/jobs?kind=verify"
check "it is found by its kind" "$id" "$(field '.jobs[].id')"

fetch POST /api/v1/jobs --data-binary '{"kind":"verify","case":"thick-cylinder-neo-hook"}'
check "an unknown case is refused" 422 "$CODE"
check "where" /case "$(field .pointer)"
check_match "with the nearest one" 'thick-cylinder-neo-hooke' "$(field .detail)"
fetch POST /api/v1/jobs --data-binary '{"kind":"verify","case":"elastica","refinement":9}'
check "so is a refinement too far" "422 /refinement" "$CODE $(field .pointer)"
finish
