#!/bin/bash
# A bellows that snaps, through the daemon with the real solver: its metrics and plots.
. "$(dirname "$0")/lib.sh"
limit=2048
# The shadow memory of a sanitizer does not fit under a limit of private memory.
grep -aqE '__(asan|tsan)_init' "$BIN/pneulab-solve" && limit=0
start_daemon --solver "$BIN/pneulab-solve" --memory-limit "$limit"
# Soft enough to snap without touching itself.
bellows='{"kind":"snap","name":"soft","actuator":{"family":"frustum-bellows","outer_diameter":"40 mm",
 "wall":"0.6 mm","snapping_angle":"40 deg","supporting_angle":"55 deg","snapping_slant":"6 mm","pet_thickness":"0.25 mm"},
 "silicone":{"model":"neo-hooke","mu":"2 MPa"},"pet":{"modulus":"0.1 GPa"},"contact":false,"accuracy":"fast",
 "load":{"pressure_to":"1 kPa","vacuum_to":"-10 kPa"},"harmonics":{"to":0}}'

fetch POST /api/v1/jobs:validate --data-binary "$bellows"
check "the bellows is valid" true "$(field .valid)"
fetch POST /api/v1/jobs -H 'Prefer: wait=60' --data-binary "$bellows"
id=$(field .id)
check "it succeeds" succeeded "$(wait_state "$id" 'succeeded|failed|timed_out' 120)"
fetch GET "/api/v1/jobs/$id"
check "its kind" snap "$(field .kind)"
links=$(field '.links.plots[]')
fetch GET "/api/v1/jobs/$id/metrics"
check "it has two stable states" 2 "$(field .metrics.stable_states)"
check "it snaps below its largest pressure" true \
  "$(field '.metrics.trigger_pressure_kPa > 0 and .metrics.trigger_pressure_kPa < 1')"
check "vacuum returns it" true "$(field '.metrics.release_pressure_kPa < 0')"
check "they are rows of the database" 1 \
  "$(sql "select count(*) from metric where job_id = $id and name = 'trigger_pressure_kPa'")"
fetch GET "/api/v1/jobs/$id/result"
check "its paths" "axial pressure vacuum pressure from natural" "$(field '[.paths[].name] | join(" ")')"
check "the path by pressure ends stretched" true \
  "$(field '.paths[1].points[-1] | .stable and .inverted_shells == 0 and .pressure_kPa > 0.999')"
check "shapes of silicone and PET" "pet silicone" \
  "$(field '[.shapes[].regions[].region] | unique | join(" ")')"
for link in $links; do
  fetch GET "$link"
  check "GET $link" 200 "$CODE"
done
check_match "it has a plot of its path" "/plots/snap-path.png" "$links"

fetch POST /api/v1/jobs --data-binary "${bellows/40 deg/60 deg}"
check "shells in the wrong order are refused" "422 /actuator/snapping_angle" "$CODE $(field .pointer)"
fetch POST /api/v1/jobs --data-binary "${bellows/\"6 mm\"/\"30 mm\"}"
check "so are shells that cross the axis" "422 /actuator/snapping_slant" "$CODE $(field .pointer)"
finish
