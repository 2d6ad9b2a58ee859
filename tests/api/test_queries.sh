#!/bin/bash
# The questions of docs/QUERIES.md on the database of a real daemon, which has conducted the study of
# that page. The formulas of the stand-in are those of check_queries.py.
. "$(dirname "$0")/lib.sh"
command -v python3 > /dev/null || { echo "SKIP: python3 is not installed"; exit 77; }
here=$(cd "$(dirname "$0")" && pwd)
page=$here/../../docs/QUERIES.md

stand_in=$(cat <<'END'
result=$(jq -c '(.actuator.side_wall | split(" ")[0] | tonumber) as $wall | .actuator.chambers[0].count as $n |
  (if .material == "elastic-50a" then 1 else 1.6 end) as $soft | (if .accuracy == "standard" then 1 / 1.015 else 1 end) as $fine |
  def angle: 1.21 * $n / 12 * 2 / $wall * $soft * . * (1 + 0.004 * .) * $fine;
  if $wall == 1.5 and $n == 12 and $soft > 1 then
    { status: "diverged", reason: "diverged", message: "The step became too small.", metrics: {}, samples: [] }
  else
    { status: "succeeded", reason: "", message: "", metrics: { bending_angle_deg: (50 | angle), mass_g: (10 + 0.3 * $n * ($wall + 4)) },
      samples: [range(0; 51; 10) | { pressure_kPa: ., bending_angle_deg: angle }] }
  end + { provenance: { version: "0.1.0" } }' "$job")
printf '%s\n' "$result"
[[ $result != *'"status":"diverged"'* ]] || exit 3
END
)
start_daemon --workers 2 --solver "$(solver "$stand_in")"
study=$(python3 "$here/check_queries.py" "$page" --study)
check "the study of the page is the first job" 1 "$(submit "$study")"
check "it is conducted" succeeded "$(wait_state 1 'succeeded|failed|timed_out' 90)"
check "the same, finer, is job 26" 26 "$(submit "$(printf '%s' "$study" | jq -c '.set["/accuracy"] = "standard"')")"
check "it is conducted, too" succeeded "$(wait_state 26 'succeeded|failed|timed_out' 90)"
answers=$(python3 "$here/check_queries.py" "$page" "$DATA/pneulab.db")
check "every answer is right" 0 "$?"
check "all ten" "" "$(printf '%s\n' "$answers" | grep -v '^ok: ')"
fetch GET '/api/v1/studies/1/ranking?criteria=max:bending_angle_deg:0.6,min:mass_g:0.4&limit=10'
check "the ranking over HTTP is that of SQL" \
  "$(sql "$(python3 "$here/check_queries.py" "$page" --sql 8)" | cut -d'|' -f 2 | paste -sd,)" \
  "$(field '[.designs[].job] | join(",")')"
finish
