#!/bin/bash
# The real solver behind the real daemon: one quick job from document to plot.
. "$(dirname "$0")/lib.sh"
limit=2048
# The shadow memory of a sanitizer does not fit under a limit of private memory.
grep -aqE '__(asan|tsan)_init' "$BIN/pneulab-solve" && limit=0
start_daemon --solver "$BIN/pneulab-solve" --memory-limit "$limit"

# A coarse mesh: the thread sanitizer makes the solver some fifty times slower.
coarse='.mesh = {gap_wall: 1, cavity: 1, half_width: 1, side_wall: 1, bottom: 1, height: 1, top: 1}'
fetch POST /api/v1/jobs -H 'Prefer: wait=60' \
  --data-binary "$(job "$coarse | .timeout = \"5 min\" | .error_estimate = false")"
id=$(field .id)
state=$(wait_state "$id" 'succeeded|failed|timed_out' 300)
check "it succeeds" succeeded "$state"
fetch GET "/api/v1/jobs/$id"
check_match "it bends" '^[1-9][0-9]*\.[0-9]+$' "$(field .metrics.bending_angle_deg)"
check "the daemon and the solver agree on the specification" "$(field .spec_hash)" \
  "$(curl -s "$URL/api/v1/jobs/$id/result" | jq -r .provenance.spec_hash)"
fetch GET "/api/v1/jobs/$id/result"
check "a sample a recorded step and one at rest" 3 "$(field '.samples | length')"
check "the angle grows with the pressure" true "$(field '[.samples[].bending_angle_deg] | . == sort')"
fetch GET "/api/v1/jobs/$id"
for link in $(field '.links.plots[], .links.artifacts[]'); do
  fetch GET "$link"
  check "GET $link" 200 "$CODE"
done
type_of() { curl -s -o "$WORK/file" -w '%{content_type}' "$URL/api/v1/jobs/$id/artifacts/$1"; }
check "type of VTU, which no browser shows" application/octet-stream "$(type_of volume-0002.vtu)"
check "type of PVD" application/octet-stream "$(type_of surface.pvd)"
check "type of the deck" 'text/plain; charset=utf-8' "$(type_of model.inp)"
check "type of the midlines" 'text/csv; charset=utf-8' "$(type_of midlines.csv)"
check "the table of the solver is that of the interface" "$(curl -s "$URL/api/v1/jobs/$id/samples.csv" | wc -l)" \
  "$(curl -s "$URL/api/v1/jobs/$id/artifacts/samples.csv" | wc -l)"
check "comparison" "$id|succeeded|12.0" "$(sql 'select id, state, chambers from comparison')"
check "an attempt used processor time" 1 "$(sql 'select count(*) from attempt where cpu_s > 0 and peak_memory_MB > 0')"

# Cancelling it in mid-solve.
heavy=$(submit "$(job '.accuracy = "fine" | .load.pressure.steps = 50')")
check "a heavy job runs" running "$(wait_state "$heavy" running)"
fetch POST "/api/v1/jobs/$heavy/cancel" -H 'Prefer: wait=20'
check "and can be cancelled" cancelled "$(field .state)"
finish
