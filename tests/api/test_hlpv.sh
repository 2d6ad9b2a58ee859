#!/bin/bash
# A hybrid model through the daemon with the real solver: a preset, its switch, its plots.
. "$(dirname "$0")/lib.sh"
limit=2048
# The shadow memory of a sanitizer does not fit under a limit of private memory.
grep -aqE '__(asan|tsan)_init' "$BIN/pneulab-solve" && limit=0
start_daemon --solver "$BIN/pneulab-solve" --memory-limit "$limit"
preset=$(dirname "$0")/../../jobs/beast/20A-0.18.json

fetch POST /api/v1/jobs:validate --data-binary "@$preset"
check "the preset is valid" true "$(field .valid)"
fetch POST /api/v1/jobs -H 'Prefer: wait=60' --data-binary "@$preset"
id=$(field .id)
check "it succeeds" succeeded "$(wait_state "$id" 'succeeded|failed|timed_out' 120)"
fetch GET "/api/v1/jobs/$id"
check "its kind" hlpv "$(field .kind)"
check "the largest extension ratio" true "$(field '.metrics.extension_ratio > 0.6 and .metrics.extension_ratio < 0.65')"
check "one switch is counted" 1 "$(field .metrics.event_count)"
links=$(field '.links.plots[]')
fetch GET "/api/v1/jobs/$id/metrics"
check "the force at 8 psi" true "$(field '.metrics.output_force_N > 44 and .metrics.output_force_N < 48')"
fetch GET "/api/v1/jobs/$id/result"
check "it snaps" "compressed stretched" "$(field '.events[0] | "\(.from) \(.to)"')"
check "as 27.58 kPa are set" true "$(field '.events[0].time_s > 40 and .events[0].time_s < 40.1')"
check "to 39.97 mm" true "$(field '.events[0].after.h_m - 0.03997 | fabs < 1e-9')"
check "the final mode" stretched "$(field .final.mode)"
check "seventeen held set-points" 17 "$(field '.holds | length')"
check "samples at 120 Hz" 20401 "$(field '.samples | length')"
check "samples are rows of the database" 20401 \
  "$(sql "select count(*) from sample where job_id = $id and name = 'h_mm'")"
check "so is the speed" 1 "$(sql "select count(*) from metric where job_id = $id and name = 'peak_speed_m_s'")"
for link in $links; do
  fetch GET "$link"
  check "GET $link" 200 "$CODE"
done
for plot in time phase steady; do
  check_match "it has a plot $plot" "/plots/$plot.png" "$links"
done

# Bounces without end are a result, too.
ball='{"kind":"hlpv","model":{"mass":"1 kg","gamma":"1 N/kPa","modes":{"air":{"stiffness":"0 N/m",
 "damping":"0 N s/m","alpha":"0 1/s","beta":"0 1/s"}},"transitions":[{"from":"air","to":"air",
 "when":{"h":"0 mm","direction":"falling"},"reset":{"velocity":{"times":-0.8}}}]},
 "initial":{"mode":"air","h":"1 m","pressure":"-10 kPa"},"input":{"hold":[["0 s","0 kPa"]]},"end":"10 s"}'
fetch POST /api/v1/jobs -H 'Prefer: wait=60' --data-binary "$ball"
id=$(field .id)
check "a ball that comes to rest fails" failed "$(wait_state "$id" 'succeeded|failed|timed_out' 60)"
fetch GET "/api/v1/jobs/$id"
check "by name" zeno "$(field .reason_code)"

fetch POST /api/v1/jobs --data-binary "${ball/\"h\":\"1 m\"/\"h\":\"-1 m\"}"
check "a start beyond a guard is refused" "422 /initial/h" "$CODE $(field .pointer)"
fetch POST /api/v1/jobs --data-binary "${ball/\"10 s\"/\"10 h\"}"
check "so are too many samples" "422 /sample_rate" "$CODE $(field .pointer)"
finish
