#!/bin/bash
# A job from submission to result, through every resource it has.
. "$(dirname "$0")/lib.sh"
start_daemon --solver "$(solver 'progress 0.5 25; echo "solving" >&2; result succeeded')"

fetch POST /api/v1/jobs --data-binary "$(job)"
check "submission is accepted" 202 "$CODE"
check "location names the job" /api/v1/jobs/1 "$(header Location)"
check "first job has id 1" 1 "$(field .id)"
check_match "its state is one of the open ones" '^(queued|starting|running|succeeded)$' "$(field .state)"
check "it becomes succeeded" succeeded "$(wait_state 1 'succeeded|failed')"

fetch GET /api/v1/jobs/1
check "name" "twelve chambers" "$(field .name)"
check "labels" '{"suite":"api"}' "$(field .labels)"
check "progress" 1 "$(field .progress)"
check "metrics in the job" 64.25 "$(field .metrics.bending_angle_deg)"
check_match "spec hash" '^[0-9a-f]{64}$' "$(field .spec_hash)"
check_match "finished" '^20..-..-..T..:..:..\....Z$' "$(field .finished)"
check "only artifacts that exist under plain names" '["/api/v1/jobs/1/artifacts/surface.json"]' "$(field .links.artifacts)"
for link in $(field '.links | .self, .document, .result, .metrics, .samples, .log, .attempts, .plots[0], .artifacts[0]'); do
  fetch GET "$link"
  check "link $link works" 200 "$CODE"
  size=$(wc -c < "$WORK/body")
  check "HEAD $link has the same length" "$size" "$(curl -sI "$URL$link" | tr -d '\r' | sed -n 's/^Content-Length: //p')"
done
fetch GET /api/v1/jobs/1/metrics
check "metrics" '{"metrics":{"bending_angle_deg":64.25,"mass_g":3.5}}' "$(field .)"
fetch GET /api/v1/jobs/1/samples.csv
check "samples as CSV" "pressure_kPa,bending_angle_deg 0,0 50,64.25" "$(tr -d '\r' <<< "$BODY" | paste -sd' ')"
fetch GET /api/v1/jobs/1/log
check "the worker's standard error" solving "$BODY"
fetch GET /api/v1/jobs/1/attempts
check "one attempt" '[1,"succeeded",0]' "$(field '.attempts[] | [.number, .outcome, .exit_code]')"
fetch GET /api/v1/jobs/1/document
check "the document as submitted" "$(job | jq -cS .)" "$(printf '%s' "$BODY" | jq -cS .)"
fetch GET '/api/v1/jobs/1/plots/angle.png?theme=blue'
check "a picture has one of two themes" 400 "$CODE"
fetch GET '/api/v1/jobs/1/plots/angle.png?theme=dark'
check "a dark picture" 200 "$CODE"
fetch GET '/api/v1/jobs/1/plots/angle.png?width=640&height=480'
check "plot type" image/png "$(header Content-Type)"
check "plot width" "640" "$(od -An -tu1 -j16 -N4 "$WORK/body" | awk '{ print (($1*256+$2)*256+$3)*256+$4 }')"
fetch GET /api/v1/jobs/1/plots/midline3d.png
check "a plot that this body has not" 404 "$CODE"
check_match "why" 'stays in its plane' "$(field .detail)"
fetch GET /api/v1/jobs/1/plots/curves.png
check "a plot of another kind" 404 "$CODE"
fetch GET '/api/v1/jobs/1/plots/angle.png?width=100000'
check "a plot too wide" 400 "$CODE"

# The database tells the same, to anybody with sqlite3.
check "comparison view" "1|succeeded|12.0|118.0|50.0|64.25" \
  "$(sql 'select id, state, chambers, length_mm, pressure_to_kPa, bending_angle_deg from comparison')"
check "samples" "0.0|0.0 50.0|64.25" "$(sql 'select pressure_kPa, bending_angle_deg from sample_row where job_id = 1 order by step' | paste -sd' ')"
check "parameters in SI" "0.0015|1.5 mm|m" "$(sql "select value, text, unit from design_parameter where pointer = '/actuator/top_wall'")"
check "history" "queued starting running succeeded" "$(sql 'select state from event order by id' | paste -sd' ')"

# Waiting.
fetch POST /api/v1/jobs -H 'Prefer: wait=20' --data-binary "$(job '.name = "waited"')"
check "a wait answers with the finished job" "200 succeeded wait=20" "$CODE $(field .state) $(header Preference-Applied)"

# Idempotency.
fetch POST /api/v1/jobs -H 'Idempotency-Key: k-1' --data-binary "$(job '.name = "once"')"
first=$(field .id)
fetch POST /api/v1/jobs -H 'Idempotency-Key: k-1' --data-binary "$(job '.name = "once"')"
check "the same key and document: the same job" "202 $first" "$CODE $(field .id)"
fetch POST /api/v1/jobs -H 'Idempotency-Key: k-1' --data-binary "$(job '.name = "other"')"
check "the same key, another document" "422 idempotency_key_reused" "$CODE $(field .code)"
check "one job was made" 1 "$(sql "select count(*) from job where idempotency_key = 'k-1'")"
fetch POST /api/v1/jobs -H "Idempotency-Key: $(printf '%0300d' 7)" --data-binary "$(job)"
check "a key that is too long" 400 "$CODE"

# Other resources.
fetch POST /api/v1/jobs:validate --data-binary "$(job)"
check "validate" "200 true" "$CODE $(field .valid)"
before=$(sql 'select count(*) from job')
fetch POST /api/v1/jobs:validate --data-binary "$(job '.load.pressure.to = "50"')"
check "validate refuses" "422 /load/pressure/to" "$CODE $(field .pointer)"
check "validate stores nothing" "$before" "$(sql 'select count(*) from job')"
fetch GET /api/v1/materials
check_match "materials" elastic-50a "$(field '[.materials[].name] | join(" ")')"
fetch GET /api/v1/schemas/job
check "job schema" true "$(field 'has("$schema")')"
fetch GET /api/v1/schemas/result
check "result schema" true "$(field 'has("$schema")')"
for path in /openapi.yaml /readyz /metrics / /jobs/1; do
  fetch GET $path
  check "GET $path" 200 "$CODE"
  check_match "policy of $path" "default-src 'none'.*frame-ancestors 'none'" "$(header Content-Security-Policy)"
done
fetch GET /metrics
check "succeeded jobs in the Prometheus text" "$(sql "select count(*) from job where state = 'succeeded'")" \
  "$(sed -n 's/^pneulab_jobs{state="succeeded"} //p' <<< "$BODY")"
etag=$(curl -sI "$URL/" | tr -d '\r' | sed -n 's/^ETag: //p')
fetch GET / -H "If-None-Match: $etag"
check "a page that is known already" 304 "$CODE"

# Comparing.
other=$(submit "$(job '.actuator.top_wall = "2 mm"')")
same=$(submit "$(job '.actuator.top_wall = "0.0015 m"')")
wait_state "$other" succeeded > /dev/null; wait_state "$same" succeeded > /dev/null
fetch GET "/api/v1/compare?jobs=1,$other,$same"
check "only what differs" '[["/actuator/top_wall","m",[0.0015,0.002,0.0015]]]' "$(field '[.parameters[] | [.pointer, .unit, .values]]')"
check "metrics side by side" '[64.25,64.25,64.25]' "$(field '.metrics[] | select(.name == "bending_angle_deg") | .values')"
fetch GET "/api/v1/plots/overlay.png?jobs=1,$other"
check "overlay" "200 image/png" "$CODE $(header Content-Type)"
for query in 'jobs=' 'jobs=1,' 'jobs=1,1' 'jobs=x' '' 'jobs=1&jobs=2' 'jobs=1,-2' 'jobs=99999999999999999999'; do
  fetch GET "/api/v1/compare?$query"
  check "compare with '$query'" 400 "$CODE"
done
fetch GET '/api/v1/compare?jobs=1,4711'
check "compare with a job that does not exist" 404 "$CODE"
fetch GET "/compare?job.1=on&job.$other=on"
check "jobs marked in the list on a page" "200 1,$other" \
  "$CODE $(grep -oE 'overlay.png\?jobs=[0-9,]*' <<< "$BODY" | head -1 | cut -d= -f2)"
for path in '/compare?jobs=1,x' '/submit?from=0'; do
  fetch GET "$path"
  check "the page $path says why not" "400 text/html" "$CODE $(header Content-Type | cut -d';' -f1)"
  check_match "$path: what is allowed" 'expected' "$BODY"
done
for path in '/compare?jobs=1,4711' '/submit?from=4711'; do
  fetch GET "$path"
  check "no page $path" "404 text/html" "$CODE $(header Content-Type | cut -d';' -f1)"
  check_match "$path: which job" 4711 "$BODY"
done

# The API description and the routes agree: each path offers exactly the methods it is said to.
fetch GET /openapi.yaml
described=$(awk '/^paths:/ { on = 1 } /^components:/ { on = 0 }
  on && /^  \// { path = $1; sub(/:$/, "", path); next }
  on && /^    (get|post|delete|put|patch):/ { sub(/:.*/, "", $1); print path, toupper($1) }' <<< "$BODY")
check "paths are described" true "$([ "$(wc -l <<< "$described")" -ge 26 ] && echo true)"
for path in $(cut -d' ' -f1 <<< "$described" | sort -u); do
  want=$(sed -n "s|^$path ||p" <<< "$described" | sed 's/^GET$/GET\nHEAD/' | sort | paste -sd' ')
  fetch OPTIONS "$(sed 's/{id}/1/; s/{[a-z]*}/x/' <<< "$path")"
  check "methods of $path" "405 $want" "$CODE $(header Allow | tr -d ',' | tr ' ' '\n' | sort | paste -sd' ')"
done
fetch GET /api/v1/database
check "snapshot" "200 application/vnd.sqlite3" "$CODE $(header Content-Type)"
check "the snapshot is whole" "ok $(sql 'select count(*) from job')" \
  "$(sqlite3 "$WORK/body" 'pragma integrity_check; select count(*) from job' | paste -sd' ')"
check "no snapshot is left behind" "" "$(find "$DATA" -name "snapshot*")"
finish
