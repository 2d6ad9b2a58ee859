#!/bin/bash
# A grasp through the daemon with the real solver: its metrics, samples and files, and what is refused.
. "$(dirname "$0")/lib.sh"
limit=2048
# The shadow memory of a sanitizer does not fit under a limit of private memory.
grep -aqE '__(asan|tsan)_init' "$BIN/pneulab-solve" && limit=0
start_daemon --solver "$BIN/pneulab-solve" --memory-limit "$limit"
grasp='{"kind":"grasp","name":"a plane drawn away","actuator":{"family":"pneunet","length":"40 mm","width":"16 mm",
 "height":"12 mm","chambers":[{"config":"B","count":2}],"side_wall":"2 mm","top_wall":"2 mm","bottom_layer":"3 mm"},
 "material":"dragon-skin-20","load":{"pressure":{"to":"20 kPa","steps":2}},
 "object":{"shape":{"form":"plane"},"position":[0,0,"-1 mm"],"friction":0.5},
 "grasp":{"pull":{"direction":[1,0,0],"distance":"4 mm","steps":4},"numerics":{"longest_step":"1 mm"}},
 "mesh":{"gap_wall":1,"cavity":1,"gap":1,"half_width":1,"side_wall":1,"bottom":1,"height":1,"top":1}}'

fetch POST /api/v1/jobs:validate --data-binary "$grasp"
check "the grasp is valid" true "$(field .valid)"
fetch POST /api/v1/jobs -H 'Prefer: wait=60' --data-binary "$grasp"
id=$(field .id)
check "it succeeds" succeeded "$(wait_state "$id" 'succeeded|failed|timed_out' 120)"
fetch GET "/api/v1/jobs/$id"
check "its kind" grasp "$(field .kind)"
artifacts=$(field '.links.artifacts[]')
check_match "the surface at rest" "/surface-0000.vtu" "$artifacts"
check_match "the frames for the page" "/grasp.bin" "$artifacts"
for link in $artifacts; do
  fetch GET "$link"
  check "GET $link" 200 "$CODE"
done
fetch GET "/api/v1/jobs/$id/metrics"
check "friction holds with half the normal force" true \
  "$(field '.metrics.grasp_force_peak_N > 0.1 and .metrics.grasp_force_peak_N < 0.13')"
check "the energies balance" true "$(field '.metrics.energy_error_pct < 1')"
check "the force is a row of the database" 1 \
  "$(sql "select count(*) from metric where job_id = $id and name = 'grasp_force_peak_N'")"
fetch GET "/api/v1/jobs/$id/result"
check "it is held" held "$(field .outcome)"
check "the stages in their order" "inflation pull" "$(field '[.samples[].stage] | unique | join(" ")')"
check "in the end it slips" "1 true" \
  "$(field '.samples[-1] | "\(.slip_share | round) \((.grasp_force_N / .normal_force_N - 0.5) | fabs < 0.001)"')"
fetch GET "/api/v1/jobs/$id/samples.csv"
check_match "its table" "grasp_force_N" "$(printf "%s\n" "$BODY" | head -1)"

fetch POST /api/v1/jobs --data-binary "${grasp/\"friction\":0.5/\"friction\":-0.5}"
check "negative friction is refused" "422 /object/friction" "$CODE $(field .pointer)"
fetch POST /api/v1/jobs --data-binary "${grasp/\[1,0,0\]/[0,0,0]}"
check "so is a pull without a direction" "422 /grasp/pull/direction" "$CODE $(field .pointer)"
# A pyramid without its floor.
facet='facet normal 0 0 1\nouter loop\nvertex %s\nvertex %s\nvertex 4 4 9\nendloop\nendfacet\n'
# shellcheck disable=SC2059
pyramid=$({ echo solid a; printf "$facet" '0 0 0' '9 0 0' '9 0 0' '9 9 0' '9 9 0' '0 9 0' '0 9 0' '0 0 0'; echo endsolid a; } |
  base64 -w 0)
shape="{\"form\":\"surface\",\"unit\":\"mm\",\"stl\":{\"base64\":\"$pyramid\"}}"
fetch POST /api/v1/jobs --data-binary "${grasp/'{"form":"plane"}'/$shape}"
check "so is a surface with a hole" "422 /object/shape/stl" "$CODE $(field .pointer)"
check_match "which is told where it is open" "the surface is open: the edge from \(" "$(field .detail)"
fetch POST /api/v1/jobs -H 'Prefer: wait=60' --data-binary "${grasp/-1 mm/-50 mm}"
id=$(field .id)
check "a pull out of reach is a result" succeeded "$(wait_state "$id" 'succeeded|failed|timed_out' 120)"
fetch GET "/api/v1/jobs/$id/result"
check "that says so" "never touched, the actuator never touched the object" "$(field '"\(.outcome), \(.warnings[0])"')"
fetch POST /api/v1/jobs -H 'Prefer: wait=60' --data-binary "${grasp/-1 mm/2.5 mm}"
id=$(field .id)
check "an object inside the body fails" failed "$(wait_state "$id" 'succeeded|failed|timed_out' 120)"
fetch GET "/api/v1/jobs/$id"
check_match "with place and depth" "overlap where the course begins: by 2.5 mm at \(0," "$(field .message)"
finish
