#!/bin/bash
# A study through the daemon with the real solver: one job from document to table.
. "$(dirname "$0")/lib.sh"
limit=2048
# The shadow memory of a sanitizer does not fit under a limit of private memory.
grep -aqE '__(asan|tsan)_init' "$BIN/pneulab-solve" && limit=0
start_daemon --solver "$BIN/pneulab-solve" --memory-limit "$limit" --workers 1

# study [JQ EDIT]: bodies of two chambers on coarse meshes, three distinct ones of four.
study() {
  jq -c "${1:-.}" <<'END'
{ "kind": "study", "name": "sides", "labels": { "suite": "api" },
  "base": { "kind": "response",
    "actuator": { "family": "pneunet", "length": "24 mm", "width": "20 mm", "height": "14 mm",
      "chambers": [ { "config": "B", "count": 2 } ],
      "side_wall": "2 mm", "top_wall": "2 mm", "bottom_layer": "4 mm" },
    "material": "dragon-skin-20", "load": { "pressure": { "to": "4 kPa", "steps": 1 } },
    "contact": false, "error_estimate": false, "timeout": "5 min",
    "mesh": { "gap_wall": 1, "cavity": 1, "gap": 1, "half_width": 1, "side_wall": 1, "bottom": 1,
      "height": 1, "top": 1 } },
  "sampling": "grid",
  "parameters": [ { "pointer": "/actuator/taper/left", "values": [ "0 deg", "2 deg" ] },
    { "pointer": "/actuator/taper/right", "values": [ "0 deg", "2 deg" ] } ],
  "ranking": { "stations": [ "12 mm", "24 mm" ] }, "timeout": "20 min" }
END
}

# wait_count CONDITION COUNT: waits until so many jobs meet the condition, and prints their number.
wait_count() {
  local count=0
  for _ in $(seq 200); do
    count=$(sql "select count(*) from job where $1")
    [ "$count" = "$2" ] && break
    sleep 0.05
  done
  printf '%s' "$count"
}

fetch POST /api/v1/jobs:validate --data-binary "$(study)"
check "it is valid" true "$(field .valid)"
fetch POST /api/v1/jobs -H 'Prefer: wait=60' --data-binary "$(study)"
id=$(field .id)
check "it succeeds" succeeded "$(wait_state "$id" 'succeeded|failed|timed_out' 600)"
fetch GET "/api/v1/jobs/$id"
check "its kind" study "$(field .kind)"
check "members and distinct ones are metrics" "4 4 3" \
  "$(field '.metrics | "\(.designs) \(.solved) \(.distinct)"')"
fetch GET "/api/v1/jobs/$id/result"
check "every member is in the result" 4 "$(field '.members | length')"
check "one of them as mirror image" "[null,null,1,null]" "$(field '[.members[].mirror_of]')"
check "all of them are ranked" 4 "$(field '.ranking.designs | length')"
check "a row of the database a member" 4 \
  "$(sql "select count(*) from sample where job_id = $id and name = 'bending_angle_deg'")"
check "pointers of the base are parameters of the design" 1 \
  "$(sql "select count(*) from design_parameter where job_id = $id and pointer = '/base/actuator/width'")"
fetch GET "/api/v1/jobs?kind=study"
check "it is found by its kind" "$id" "$(field '.jobs[].id')"

fetch POST /api/v1/jobs --data-binary "$(study '.parameters[1].values[1] = "80 deg"')"
check "a member that cannot be is refused" "422 /parameters/1/values/1" "$CODE $(field .pointer)"
fetch POST /api/v1/jobs --data-binary "$(study '.base = {file: "base.json"}')"
check "so is a base in a file" "422" "$CODE"

# Cancelling ends the members, too.
heavy=$(submit "$(study '.base.mesh = null | del(.base.mesh) | .base.accuracy = "fine"
  | .base.load.pressure.steps = 200')")
check "a heavy study runs" running "$(wait_state "$heavy" running)"
for _ in $(seq 200); do
  pid=$(sql "select pid from attempt join job on job.id = job_id where study_id = $heavy and state = 'running'")
  [ -n "$pid" ] && break
  sleep 0.05
done
check_match "a worker solves a member" '^[0-9]+$' "$pid"
member=$(sql "select id from job where study_id = $heavy and member = 1")
fetch POST "/api/v1/jobs/$member/hold"
check "a member is not held alone" 409 "$CODE"
fetch DELETE "/api/v1/jobs/$member"
check "a member of a live study is not deleted" 409 "$CODE"
fetch POST "/api/v1/jobs/$heavy/hold"
check "the study is held as a whole" "200 held" "$CODE $(field .state)"
check "with those who wait" 3 "$(wait_count "study_id = $heavy and state = 'held'" 3)"
fetch PATCH "/api/v1/jobs/$heavy" --data-binary '{"priority": 7}'
check "its priority can be changed" 200 "$CODE"
fetch POST "/api/v1/jobs/$heavy/release"
check "it is released" "200" "$CODE"
check "with its members, and its priority is theirs" 3 \
  "$(wait_count "study_id = $heavy and state = 'queued' and priority = 7" 3)"
curl -s -H 'Prefer: wait=60' -o "$WORK/waited" -w '%{time_total}' "$URL/api/v1/jobs/$member" > "$WORK/time" &
waiting=$!
fetch POST "/api/v1/jobs/$heavy/cancel" -H 'Prefer: wait=20'
check "it can be cancelled" cancelled "$(field .state)"
check "its members have ended with it" no "$(alive "$pid")"
wait "$waiting"
check "who waits for a member is told" cancelled "$(jq -r .state "$WORK/waited")"
check "at once" true "$(jq '. < 30' "$WORK/time")"
check "all of them" 4 "$(sql "select count(*) from job where study_id = $heavy and state = 'cancelled'")"
fetch DELETE "/api/v1/jobs/$heavy"
check "it is deleted" 204 "$CODE"
check "with its members" 0 "$(wait_count "study_id = $heavy or id = $heavy" 0)"

# A repetition solves nothing.
again=$(submit "$(study '.name = "again"')")
check "the same study once more" succeeded "$(wait_state "$again" 'succeeded|failed|timed_out' 60)"
check "takes its members from the first one" 4 \
  "$(sql "select count(*) from job where study_id = $again and reused_from is not null")"
check "its view has parameters and metrics" "0.0 0.0" \
  "$(sql "select left_deg || ' ' || right_deg from study_$again where member = 0 and bending_angle_deg > 0")"
finish
