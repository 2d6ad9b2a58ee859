#!/bin/bash
# The motion of bistable actuators through the daemon with the real solver: pushes, two actuators in
# parallel, and what is refused.
. "$(dirname "$0")/lib.sh"
limit=2048
# The shadow memory of a sanitizer does not fit under a limit of private memory.
grep -aqE '__(asan|tsan)_init' "$BIN/pneulab-solve" && limit=0
start_daemon --solver "$BIN/pneulab-solve" --memory-limit "$limit"
jobs=$(dirname "$0")/../../jobs/beast

# With a law in closed form: that of the job comes from finite elements.
push=$(jq 'del(.snap) | .laws = {snap: {per: "mm", coefficients: ["0 N", "33.1 N", "-11.27 N", "0.87 N"],
  area: "8.1 cm2", volume: "9 ml", range: ["-3 mm", "14 mm"]}}' "$jobs/push-power.json")
fetch POST /api/v1/jobs:validate --data-binary "$push"
check "the push is valid" true "$(field .valid)"
fetch POST /api/v1/jobs -H 'Prefer: wait=60' --data-binary "$push"
id=$(field .id)
check "it succeeds" succeeded "$(wait_state "$id" 'succeeded|failed|timed_out' 120)"
fetch GET "/api/v1/jobs/$id"
check "its kind" bistable "$(field .kind)"
check "three snaps" 3 "$(field .metrics.snap_count)"
check "the load gets its energy" true "$(field '.metrics | .load_energy_mJ - 100 * .load_speed_m_s * .load_speed_m_s | fabs < 1e-6')"
fetch GET "/api/v1/jobs/$id/result"
check "the load parts from the plate" true "$(field '[.events[].type] | index("separation") != null')"
check "samples are rows of the database" "$(field '.samples | length')" \
  "$(sql "select count(*) from sample where job_id = $id and name = 'load_velocity_m_s'")"
check "so is the speed of the snap" 1 "$(sql "select count(*) from metric where job_id = $id and name = 'snap_speed_m_s'")"

fetch POST /api/v1/jobs --data-binary "@$jobs/bistable-pair.json"
check "a job that names a file is refused" "422 /snap/file" "$CODE $(field .pointer)"
fetch POST /api/v1/jobs --data-binary "${push/\"mass\": \"30 g\"/\"mass\": \"-30 g\"}"
check "so is a negative mass" "422 /plate/mass" "$CODE $(field .pointer)"
fetch POST /api/v1/jobs --data-binary "${push/\"20 ml\"/\"-20 ml\"}"
check "and a negative volume" "422 /pneumatics/dead_volume" "$CODE $(field .pointer)"

# Nothing holds it: a result, too.
loose='{"kind":"bistable","laws":{"loose":{"per":"mm","coefficients":["0 N","1 N","-1 N"]}},
 "actuators":[{"cells":[{"law":"loose","mass":"20 g","elongation":"2 mm"}]}],"plate":{"mass":"40 g"},
 "input":{"hold":[["0 s","0 kPa"]]},"end":"100 s","sample_rate":"1 Hz"}'
fetch POST /api/v1/jobs -H 'Prefer: wait=60' --data-binary "$loose"
id=$(field .id)
check "a cell that is let go fails" failed "$(wait_state "$id" 'succeeded|failed|timed_out' 60)"
fetch GET "/api/v1/jobs/$id"
check "by name" diverged "$(field .reason_code)"
finish
