#!/bin/bash
# Pictures of studies over HTTP: every plot of a study whose metrics are known functions, in both
# themes, what is refused, and when a picture has to be drawn again.
. "$(dirname "$0")/lib.sh"
stand_in=$(solver 'result succeeded')
start_daemon --workers 1 --solver "$stand_in"
stop_daemon

# 40 members over two walls and a material, the last two failed; and a study of two ranked members.
study=$(job '{ kind: "study", name: "walls", base: ., sampling: "sobol", size: 40,
  parameters: [ { pointer: "/actuator/side_wall", from: "1.5 mm", to: "2.5 mm" } ] }')
sqlite3 "$DATA/pneulab.db" <<END
INSERT INTO job (id, state, kind, name, document, spec_hash, created_ms, finished_ms) VALUES
  (100, 'succeeded', 'study', 'walls', '$study', 'study', 1769860800000, 1769860900000),
  (300, 'succeeded', 'study', 'no members', '$study', 'other', 1769860800000, 1769860900000);
INSERT INTO job (id, state, kind, name, document, spec_hash, attempt, created_ms) VALUES
  (310, 'succeeded', 'study', 'ranked', '{}', 'ranked', 1, 1769860800000);
INSERT INTO study VALUES (100, 'sobol', 40, 0, 1), (300, 'sobol', 0, 0, 1), (310, 'list', 1, 0, 1);
INSERT INTO job (id, state, kind, name, document, spec_hash, created_ms, study_id, member) VALUES
  (311, 'succeeded', 'response', 'thick', '{}', 'thick', 1769860800000, 310, 0);
INSERT INTO attempt (job_id, number, created_ms) VALUES (310, 1, 1769860800000);
INSERT INTO result VALUES (310, 1, '{ "ranking": { "mean_weight": 0.7, "designs": [
  { "rank": 1, "member": 0, "name": "thick", "mean_weighted": 0.1, "normalised_variance": 1, "final": 0.07 } ] } }', 'attempts/310-1', 1769860800000);
INSERT INTO study_parameter VALUES (100, 0, '/actuator/side_wall', 'side wall', 'mm', 0, 0, 1.5, 2.5),
  (100, 1, '/actuator/top_wall', 'top wall', 'mm', 0, 0, 1, 2),
  (100, 2, '/material', 'material', '', 1, 0, NULL, NULL);
CREATE TEMP TABLE design AS
  WITH RECURSIVE n (i) AS (SELECT 0 UNION ALL SELECT i + 1 FROM n WHERE i < 39)
  SELECT i, i * 0.7548776662466927 - CAST(i * 0.7548776662466927 AS INTEGER) AS s,
    i * 0.5698402909980532 - CAST(i * 0.5698402909980532 AS INTEGER) AS t, i % 2 AS m FROM n;
INSERT INTO job (id, state, reason_code, kind, name, document, spec_hash, attempt, created_ms, study_id, member)
  SELECT 101 + i, iif(i < 38, 'succeeded', 'failed'), iif(i < 38, '', 'diverged'), 'response',
    'wall ' || i, '{}', 'design ' || i, iif(i < 38, 1, 0), 1769860800000, 100, i FROM design;
INSERT INTO study_value SELECT 100, i, 0, 1.5 + s, (1.5 + s) || ' mm' FROM design
  UNION ALL SELECT 100, i, 1, 1 + t, (1 + t) || ' mm' FROM design
  UNION ALL SELECT 100, i, 2, NULL, iif(m, 'soft', 'hard') FROM design;
INSERT INTO metric SELECT 101 + i, 'bending_angle_deg', 60 - 20 * s + 5 * t - 10 * m FROM design WHERE i < 38
  UNION ALL SELECT 101 + i, 'mass_g', 10 * (1 + s) + t FROM design WHERE i < 38;
INSERT INTO attempt (job_id, number, created_ms) SELECT 101 + i, 1, 1769860800000 FROM design WHERE i < 38;
INSERT INTO result SELECT 101 + i, 1, '{ "midlines": [ { "points_mm": [[0,0,0],[10,0,0]] },
  { "points_mm": [[0,0,0],[9,0,-3],[15,0,-9]] } ] }', 'attempts/' || (101 + i) || '-1', 1769860800000 FROM design WHERE i < 38;
END
start_daemon --workers 1 --solver "$stand_in"
at=/api/v1/studies/100/plots

for plot in curve heat-map contour parallel scatter 'pareto.png?objectives=max:bending_angle_deg,min:mass_g' \
  importance effects 'ranking.png?criteria=max:bending_angle_deg:2,min:mass_g:1' shapes history surrogate; do
  case $plot in *\?*) url="$at/$plot&" ;; *) url="$at/$plot.png?" ;; esac
  fetch GET "${url}width=420&height=300"
  check "$plot" '200 image/png' "$CODE $(header Content-Type)"
  cp "$WORK/body" "$WORK/light"
  fetch GET "${url}width=420&height=300&theme=dark"
  check "$plot, dark" '200 differs' "$CODE $(cmp -s "$WORK/light" "$WORK/body" && echo same || echo differs)"
done
cp "$WORK/body" "${PLOT_TEST_DIR:-$WORK}/surrogate.png"

fetch GET "$at/curve.png"
etag=$(header ETag)
fetch GET "$at/curve.png" -H "If-None-Match: $etag"
check "a picture that is known is not sent again" 304 "$CODE"
fetch GET "$at/curve.png?metric=mass_g" -H "If-None-Match: $etag"
check "another one is" 200 "$CODE"
fetch GET "$at/contour.png?x=/actuator/side_wall&y=/actuator/top_wall&at./material=soft&metric=mass_g"
check "a slice elsewhere" 200 "$CODE"
for plot in 'curve.png?metric=bending_angle_deg' 'parallel.png?metric=bending_angle_deg' scatter.png?; do
  fetch GET "$at/$plot&colour=mass_g"
  cp "$WORK/body" "$WORK/mass"
  fetch GET "$at/$plot&colour=/actuator/top_wall" -H "If-None-Match: $(header ETag)"
  check "$plot in other colours" '200 differs' \
    "$CODE $(cmp -s "$WORK/mass" "$WORK/body" && echo same || echo differs)"
done
for plot in parallel scatter; do
  fetch GET "$at/$plot.png?columns=/actuator/side_wall,mass_g"
  cp "$WORK/body" "$WORK/two"
  fetch GET "$at/$plot.png?columns=/actuator/side_wall,mass_g,bending_angle_deg" -H "If-None-Match: $(header ETag)"
  check "$plot of other columns" '200 differs' \
    "$CODE $(cmp -s "$WORK/two" "$WORK/body" && echo same || echo differs)"
done
fetch GET /api/v1/studies/310/plots/ranking.png
check "the ranking of the document" 200 "$CODE"
fetch GET /api/v1/studies/300/plots/parallel.png
check "a study without members" 200 "$CODE"

refused() { # TITLE URL CODE WORDS
  fetch GET "$2"
  check "$1" "$3" "$CODE"
  check_match "$1: why" "$4" "$(field .detail)"
}
refused "no such plot" "$at/pie.png" 404 'heat-map'
refused "no such metric" "$at/curve.png?metric=speed" 404 'mass_g'
refused "no such parameter" "$at/heat-map.png?x=/actuator/size" 404 '/actuator/side_wall'
refused "no such colour" "$at/scatter.png?colour=speed" 404 'mass_g'
refused "no such column" "$at/parallel.png?columns=mass_g,speed" 404 'mass_g'
refused "no objectives" "$at/pareto.png" 400 'max:'
refused "words have no slice" "$at/contour.png?x=/material" 404 'effects'
refused "one parameter is no slice" "$at/contour.png?x=/actuator/side_wall&y=/actuator/side_wall" 404 'two different'
refused "a value that is none" "$at/contour.png?at./material=liquid" 400 'liquid'
refused "a theme that is none" "$at/curve.png?theme=blue" 400 'light or dark'
refused "a study without a ranking" "$at/ranking.png" 409 'not ended|result'
refused "no such study" /api/v1/studies/4711/plots/curve.png 404 4711
refused "too few members for a surrogate" /api/v1/studies/310/plots/surrogate.png 404 'solved'
finish
