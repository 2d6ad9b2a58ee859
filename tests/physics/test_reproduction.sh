#!/bin/bash
# Studies through pneulab-solve: several processes, interruption, failing members; the tool that
# lays results beside published values.
set -u
build=$(pwd)
source=$(cd "${srcdir:-.}" && pwd)
solve=$build/pneulab-solve
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
command -v jq >/dev/null || { echo "SKIP: jq is not installed"; exit 77; }
fail() {
  echo "FAILED: $1"
  exit 1
}

# check WHAT EXPECTED ACTUAL
check() {
  [ "$2" = "$3" ] || fail "$1: expected $2, got $3"
}

# study [JQ EDIT]: eight bodies of two chambers on coarse meshes, six of them distinct.
study() {
  jq -c "${1:-.}" <<'END'
{ "kind": "study", "name": "sides and gap",
  "base": { "kind": "response", "name": "two chambers",
    "actuator": { "family": "pneunet", "length": "24 mm", "width": "20 mm", "height": "14 mm",
      "chambers": [ { "config": "B", "count": 2 } ],
      "side_wall": "2 mm", "top_wall": "2 mm", "bottom_layer": "4 mm" },
    "material": "dragon-skin-20", "load": { "pressure": { "to": "8 kPa", "steps": 2 } },
    "error_estimate": false, "timeout": "5 min",
    "mesh": { "gap_wall": 1, "cavity": 1, "gap": 1, "half_width": 1, "side_wall": 1, "bottom": 1,
      "height": 1, "top": 1 } },
  "sampling": "grid",
  "parameters": [
    { "pointer": "/actuator/chamber_gap", "name": "gap", "values": [ "1 mm", "2 mm" ] },
    { "pointer": "/actuator/taper/left", "name": "left", "values": [ "0 deg", "2 deg" ] },
    { "pointer": "/actuator/taper/right", "name": "right", "values": [ "0 deg", "2 deg" ] } ],
  "ranking": { "stations": [ "8 mm", "16 mm", "24 mm" ] } }
END
}

# What does not depend on time and on how a study was run.
plain='del(.statistics, .metrics.computed, .metrics.resumed, .members[].statistics)'

# ---- one process, several, interrupted ----------------------------------------------------------

study >"$dir/study.json"
"$solve" --jobs 1 "$dir/study.json" >"$dir/one.json" || fail "a study, one member at a time"
check "members" "8 8 6 6 0" \
  "$(jq -r '.metrics | "\(.designs) \(.solved) \(.distinct) \(.computed) \(.resumed)"' "$dir/one.json")"
"$solve" --jobs 2 --events "$dir/events" --out "$dir/two" "$dir/study.json" >"$dir/two.json" ||
  fail "a study, two members at a time"
check "results with one and two processes" "$(jq -c "$plain" "$dir/one.json" | sha256sum)" \
  "$(jq -c "$plain" "$dir/two.json" | sha256sum)"
check "the last event" 1 "$(tail -n 1 "$dir/events" | jq .fraction)"
check "files of members" 6 "$(find "$dir/two/members" -name '*.job.json' | wc -l)"

# A member alone, and the mirror image of one, are what the study says.
study '.base' | jq -c '.actuator.chamber_gap = "1 mm" | .actuator.taper = {right: "2 deg"}' |
  "$solve" - >"$dir/alone.json"
check "a member alone" "$(jq -c .samples "$dir/alone.json")" \
  "$(jq -c '.members[1].samples' "$dir/one.json")"
study '.base' | jq -c '.actuator.chamber_gap = "1 mm" | .actuator.taper = {left: "2 deg"}' |
  "$solve" - >"$dir/mirror.json"
check "a mirrored member" 1 "$(jq '.members[2].mirror_of' "$dir/one.json")"
jq -e --slurpfile other "$dir/mirror.json" '
  .members[2] as $m | $other[0] as $o |
  def near(a; b): (a - b) | fabs < 1e-6;
  near($m.samples[-1].tip_y_mm; $o.samples[-1].tip_y_mm) and $o.samples[-1].tip_y_mm > 1e-4 and
  near($m.samples[-1].bending_angle_deg; $o.samples[-1].bending_angle_deg) and
  near($m.midlines[-1].points_mm[-1][1]; $o.midlines[-1].points_mm[-1][1])' \
  "$dir/one.json" >/dev/null || fail "the mirror image of a member"

# Killed without notice once two members are there, then run again.
"$solve" --jobs 1 --out "$dir/cut" "$dir/study.json" >"$dir/cut.json" 2>/dev/null &
pid=$!
for _ in $(seq 2000); do
  [ "$(find "$dir/cut/members" -name '*.json' ! -name '*.job.json' 2>/dev/null | wc -l)" -ge 2 ] && break
  sleep 0.005
done
kill -9 $pid 2>/dev/null
wait $pid 2>/dev/null
kept=$(find "$dir/cut/members" -name '*.json' ! -name '*.job.json' | wc -l)
find "$dir/cut/members" -name '*.json' ! -name '*.job.json' -exec stat -c '%n %i' {} + |
  sort >"$dir/before"
"$solve" --jobs 2 --out "$dir/cut" "$dir/study.json" >"$dir/again.json" || fail "the second run"
check "the result after an interruption" "$(jq -c "$plain" "$dir/one.json" | sha256sum)" \
  "$(jq -c "$plain" "$dir/again.json" | sha256sum)"
check "nothing solved twice" "$kept $((6 - kept))" \
  "$(jq -r '.metrics | "\(.resumed) \(.computed)"' "$dir/again.json")"
find "$dir/cut/members" -name '*.json' ! -name '*.job.json' -exec stat -c '%n %i' {} + |
  sort >"$dir/after"
check "files of the first run" "$(cat "$dir/before")" "$(grep -xFf "$dir/before" "$dir/after")"

# A damaged result and one of another version are solved again.
first=$(jq -r '.members[0].spec_hash' "$dir/one.json")
other=$(jq -r '.members[1].spec_hash' "$dir/one.json")
echo '{' >"$dir/cut/members/$first.json"
sed -i 's/"version": "[^"]*"/"version": "0.0.0"/' "$dir/cut/members/$other.json"
"$solve" --out "$dir/cut" "$dir/study.json" >"$dir/mended.json"
check "what is solved again" 2 "$(jq .metrics.computed "$dir/mended.json")"

# ---- members that fail --------------------------------------------------------------------------

study '.sampling = "list" | del(.parameters) | .designs = [ {set: {}},
  {name: "too much", set: {"/load/pressure/to": "200 kPa"}} ]' |
  "$solve" - >"$dir/limit.json" || fail "a study with a member that diverges"
check "a diverging member is data" "succeeded diverged 1 1" \
  "$(jq -r '"\(.status) \(.members[1].status) \(.metrics.failed) \(.metrics.diverged)"' "$dir/limit.json")"
check "it is not ranked" "[1]" "$(jq -c .ranking.left_out "$dir/limit.json")"

# A member that crashes, or is stuck when the study ends.
heavy='del(.base.mesh) | .base.accuracy = "fine" | .base.load.pressure.steps = 500 |
  .sampling = "list" | del(.parameters)'
study "$heavy"' | .designs = [ {set: {}} ]' >"$dir/heavy.json"
"$solve" --jobs 1 --out "$dir/crash" "$dir/heavy.json" >"$dir/crash.json" 2>/dev/null &
pid=$!
member=
for _ in $(seq 500); do
  member=$(pgrep -P $pid | head -n 1)
  [ -n "$member" ] && break
  sleep 0.01
done
[ -n "$member" ] || fail "no process of a member"
kill -9 "$member"
wait $pid
check "the exit code when no member could be solved" 3 $?
check "a crash is data" "diverged failed crashed" \
  "$(jq -r '"\(.status) \(.members[0].status) \(.members[0].reason)"' "$dir/crash.json")"
study "$heavy"' | .designs = [ {set: {}} ] | .timeout = "1 s"' |
  "$solve" --jobs 1 - >"$dir/late.json"
check "the exit code of a study out of time" 3 $?
check "a study out of time" "timeout not_run" \
  "$(jq -r '"\(.reason) \(.members[0].reason)"' "$dir/late.json")"

# ---- the tool -----------------------------------------------------------------------------------

if [ -x "$build/tools/reproduction" ]; then
  mkdir -p "$dir/source/jobs/multicurvature" "$dir/source/jobs/tapered" "$dir/source/docs/figures"
  study .base >"$dir/source/jobs/multicurvature/two.json"
  study '.base | .actuator.chamber_gap = "2 mm"' >"$dir/source/jobs/tapered/other.json"
  study '.base = {file: "two.json"}' >"$dir/source/jobs/multicurvature/sides.json"
  cat >"$dir/source/docs/reproduction.json" <<'END'
{ "values": [
    { "paper": "multicurvature", "what": "angle", "published": 3.5, "unit": "deg",
      "ours": { "from": "multicurvature/two", "value": "/metrics/bending_angle_deg" } },
    { "paper": "multicurvature", "what": "half of it", "published": 10, "relation": "below",
      "ours": { "from": "multicurvature/two", "key": "bending_angle_deg", "at_kPa": 4 } },
    { "paper": "multicurvature", "what": "less", "published": 0,
      "ours": { "difference": [ { "from": "multicurvature/two", "value": "/metrics/bending_angle_deg" },
        { "from": "tapered/other", "value": "/metrics/bending_angle_deg" } ] } },
    { "paper": "multicurvature", "what": "over", "published": 1,
      "ours": { "ratio": [ { "from": "tapered/other", "value": "/metrics/bending_angle_deg" },
        { "from": "multicurvature/two", "value": "/metrics/bending_angle_deg" } ] } },
    { "paper": "multicurvature", "what": "shifts", "published": 3, "relation": "below",
      "ours": { "shift_ratio": [ { "from": "tapered/other", "value": "/metrics/bending_angle_deg" },
        { "from": "multicurvature/two", "value": "/metrics/bending_angle_deg" },
        { "from": "multicurvature/two", "value": "/metrics/bending_angle_deg" },
        { "from": "tapered/other", "key": "bending_angle_deg", "at_kPa": 0 } ] } },
    { "paper": "multicurvature", "what": "half of it at last", "published": 10, "relation": "below",
      "ours": { "from": "multicurvature/two", "key": "bending_angle_deg", "at_kPa": 4, "last": true } },
    { "paper": "multicurvature", "what": "no path", "published": 1,
      "ours": { "from": "multicurvature/two", "path": "axial", "key": "bending_angle_deg", "at_kPa": 4 } },
    { "paper": "tapered", "what": "another's", "published": "not given",
      "ours": { "from": "tapered/other", "value": "/metrics/bending_angle_deg" } },
    { "paper": "multicurvature", "what": "nobody's", "published": 1,
      "ours": { "from": "multicurvature/three", "value": "/metrics/bending_angle_deg" } } ],
  "trends": [
    { "paper": "multicurvature", "what": "gap", "direction": "rising", "steps": [
      { "label": "1", "from": "multicurvature/sides#gap 1 mm, left 0 deg, right 0 deg", "value": "/metrics/bending_angle_deg" },
      { "label": "2", "from": "multicurvature/sides#gap 2 mm, left 0 deg, right 0 deg", "value": "/metrics/bending_angle_deg" } ] },
    { "paper": "multicurvature", "what": "groups", "direction": "falling", "groups": [
      [ { "label": "1", "from": "multicurvature/sides#gap 1 mm, left 0 deg, right 0 deg", "value": "/metrics/bending_angle_deg" },
        { "label": "2", "from": "multicurvature/sides#gap 2 mm, left 0 deg, right 0 deg", "value": "/metrics/bending_angle_deg" } ],
      [ { "label": "3", "from": "multicurvature/sides#gap 1 mm, left 2 deg, right 2 deg", "value": "/metrics/bending_angle_deg" } ] ] } ],
  "figures": [
    { "paper": "multicurvature", "from": "multicurvature/two", "plot": "angle", "file": "two", "caption": "Two" },
    { "paper": "tapered", "from": "tapered/other", "plot": "angle", "file": "other", "caption": "Other" },
    { "paper": "multicurvature", "from": ["multicurvature/two", "tapered/other"], "plot": "overlay", "file": "both", "caption": "Both" },
    { "paper": "multicurvature", "from": "multicurvature/three", "plot": "angle", "file": "three", "caption": "Three" } ],
  "ranking": { "from": "multicurvature/sides", "mean_weight": 0.5, "best": 3, "published": [
    { "rank": 1, "name": "gap 2 mm, left 2 deg, right 2 deg", "mean": 0.648, "variance": 0.269, "final": 0.6729 } ] } }
END
  for section in VALUES TRENDS FIGURES; do
    printf '@%s multicurvature@\n' $section
  done >"$dir/source/docs/REPRODUCTION.in.md"
  printf '@VALUES tapered@\n@FIGURES tapered@\n@RANKING@\n@RUNS@\nthe end\n' >>"$dir/source/docs/REPRODUCTION.in.md"
  reproduce() {
    "$build/tools/reproduction" --solver "$solve" --source "$dir/source" --build "$dir/rep" "$@" \
      2>"$dir/said" || { cat "$dir/said"; fail "the tool"; }
  }
  document=$dir/source/docs/REPRODUCTION.md
  reproduce --only two
  grep -q '^| gap | rising | 1: missing, 2: missing | missing |$' "$document" ||
    fail "the part that was not run: $(cat "$document")"
  reproduce
  check "runs of the second call" 2 "$(grep -c '^  run ' "$dir/said")"
  reproduce
  check "runs of the third call" 0 "$(grep -c '^  run ' "$dir/said")"
  angle=$(jq '.metrics.bending_angle_deg' "$dir/rep/multicurvature/two/result.json")
  grep -q "^| angle | 3.5 deg | $(printf %.4g "$angle") deg | .* %) | not estimated |$" "$document" ||
    fail "a value: $(cat "$document")"
  grep -q '^| half of it | below 10 | .* | holds | not estimated |$' "$document" || fail "a bound"
  check "the first time and the last" "$(grep '^| half of it |' "$document" | cut -d'|' -f4)" \
    "$(grep '^| half of it at last |' "$document" | cut -d'|' -f4)"
  grep -q '^| no path | 1 | missing: succeeded |' "$document" || fail "a path that is not there"
  grep -q "^| nobody's | 1 | missing: multicurvature/three" "$document" || fail "a missing value"
  grep -q '^| gap | rising | 1: .*, 2: .* | yes |$' "$document" || fail "a trend"
  grep -q '^| groups | falling | 1: .*, 2: .*, 3: .* | yes |$' "$document" || fail "groups"
  grep -q '| 0.6729 | 0.6895 | [1-8] |' "$document" || fail "the printed formula"
  grep -q '^!\[Two\](figures/reproduction/two.png)$' "$document" || fail "a figure"
  grep -q '^\*Three\*: missing' "$document" || fail "a missing figure"
  grep -q '^the end$' "$document" || fail "the template's own lines"
  other=$(jq '.metrics.bending_angle_deg' "$dir/rep/tapered/other/result.json")
  grep -q "^| less | 0 | $(jq -nr "$angle - $other" | xargs printf %.4g) | " "$document" || fail "a difference"
  grep -q "^| over | 1 | $(jq -nr "$other / $angle" | xargs printf %.4g) | " "$document" || fail "a ratio"
  # both shifts in size: that between the two bodies, and that of one from nothing
  grep -q "^| shifts | below 3 | $(jq -nr "(($angle - $other) / $angle) | fabs" | xargs printf %.4g) | holds" \
    "$document" || fail "a ratio of shifts: $(cat "$document")"
  [ -s "$dir/source/docs/figures/reproduction/two.png" ] || fail "the picture"
  [ -s "$dir/source/docs/figures/reproduction/both.png" ] || fail "the picture of two jobs"
  [ -s "$dir/rep/multicurvature/two/angle.png" ] || fail "the pictures of a result"
  # what --only leaves alone keeps its section, its picture and its row, though its result is gone
  cp "$document" "$dir/before.md"
  rm -r "$dir/rep/tapered"
  reproduce --only multicurvature
  grep -q "^| another's | not given | $(printf %.4g "$other") " "$document" || fail "a kept value"
  grep -q '^!\[Other\](figures/reproduction/other.png)$' "$document" || fail "a kept figure"
  check "the kept row" "$(grep 'jobs/tapered/other' "$dir/before.md")" "$(grep 'jobs/tapered/other' "$document")"
  check "the time of all" "$(grep '^Together' "$dir/before.md")" "$(grep '^Together' "$document")"
fi
