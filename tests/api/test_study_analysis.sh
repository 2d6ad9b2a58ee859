#!/bin/bash
# What the members of a study say together, over a study whose metrics are known functions: each
# answer against SQL or a value by hand, and the refusals.
. "$(dirname "$0")/lib.sh"
stand_in=$(solver 'result succeeded')
start_daemon --workers 1 --solver "$stand_in"
stop_daemon

# 60 members, the last three failed. With s = side wall / mm - 1.5 from 0 to 1, c = 10, 11 or 12
# chambers and the material m = 0, 1, 2: angle = 60 + 10 c - 20 s - 10 m, mass = c (1 + s).
study=$(job '{ kind: "study", name: "walls", base: ., set: { "/accuracy": "fast" }, sampling: "sobol",
  size: 60, parameters: [ { pointer: "/actuator/side_wall", from: "1.5 mm", to: "2.5 mm" },
    { pointer: "/actuator/chambers/0/count", from: 10, to: 12 },
    { pointer: "/material", values: ["elastic-50a", "dragon-skin-20", "dragon-skin-30"] } ],
  constraints: [ { sum: { "/actuator/side_wall": 2 }, at_least: "3.2 mm" } ] }')
sqlite3 "$DATA/pneulab.db" <<END
INSERT INTO job (id, state, kind, name, document, spec_hash, created_ms, finished_ms)
  VALUES (100, 'succeeded', 'study', 'walls', '$study', 'study', 1769860800000, 1769860900000),
         (300, 'succeeded', 'study', 'no members', '$study', 'other', 1769860800000, 1769860900000);
INSERT INTO study VALUES (100, 'sobol', 60, 0, 1), (300, 'sobol', 0, 0, 1), (310, 'list', 2, 0, 1),
  (320, 'list', 1, 0, 1);
INSERT INTO job (id, state, kind, name, document, spec_hash, attempt, created_ms, study_id, member) VALUES
  (310, 'succeeded', 'study', 'ranked', '{}', 'ranked', 1, 1769860800000, NULL, NULL),
  (311, 'succeeded', 'response', 'thick', '{}', 'thick', 0, 1769860800000, 310, 0),
  (312, 'succeeded', 'response', 'thin', '{}', 'thin', 0, 1769860800000, 310, 1),
  (320, 'succeeded', 'study', 'hostile', '{}', 'hostile', 1, 1769860800000, NULL, NULL),
  (321, 'succeeded', 'response', '=SUM(A1)', '{}', 'formula', 0, 1769860800000, 320, 0);
INSERT INTO attempt (job_id, number, created_ms) VALUES (310, 1, 1769860800000);
INSERT INTO result VALUES (310, 1, '{ "ranking": { "mean_weight": 0.7, "designs": [
  { "rank": 1, "member": 1, "name": "thin", "mean_weighted": 0.8, "normalised_variance": 0.25, "final": 0.785 },
  { "rank": 2, "member": 0, "name": "thick", "mean_weighted": 0.1, "normalised_variance": 1, "final": 0.07 } ] } }', 'attempts/310-1', 1769860800000);
INSERT INTO study_parameter VALUES (100, 0, '/actuator/side_wall', 'side wall', 'mm', 0, 0, 1.5, 2.5),
  (100, 1, '/actuator/chambers/0/count', 'chambers', '', 0, 0, 10, 12),
  (100, 2, '/material', 'material', '', 1, 0, NULL, NULL);
CREATE TEMP TABLE design AS
  WITH RECURSIVE n (i) AS (SELECT 0 UNION ALL SELECT i + 1 FROM n WHERE i < 59)
  SELECT i, i * 0.7548776662466927 - CAST(i * 0.7548776662466927 AS INTEGER) AS s, 10 + i % 3 AS c, (i / 3) % 3 AS m FROM n;
INSERT INTO job (id, state, reason_code, kind, name, document, spec_hash, created_ms, started_ms, finished_ms, study_id, member)
  SELECT 101 + i, iif(i < 57, 'succeeded', 'failed'), iif(i < 57, '', 'diverged'), 'response',
    'wall "' || i || '", material ' || m, '{}', 'design ' || i, 1769860800000, 1769860801000 + i, 1769860802234 + 2 * i, 100, i
  FROM design;
INSERT INTO study_value SELECT 100, i, 0, 1.5 + s, (1.5 + s) || ' mm' FROM design
  UNION ALL SELECT 100, i, 1, c, c FROM design
  UNION ALL SELECT 100, i, 2, NULL,
    CASE m WHEN 0 THEN 'elastic-50a' WHEN 1 THEN 'dragon-skin-20' ELSE 'dragon-skin-30' END FROM design;
INSERT INTO metric SELECT 101 + i, 'bending_angle_deg', 60 + 10 * c - 20 * s - 10 * m FROM design WHERE i < 57
  UNION ALL SELECT 101 + i, 'mass_g', c * (1 + s) FROM design WHERE i < 57;
END
start_daemon --workers 1 --solver "$stand_in"
at=/api/v1/studies/100

# near A B TOLERANCE: yes or no.
near() {
  awk -v a="$1" -v b="$2" -v t="$3" 'BEGIN { print (a - b < t && b - a < t) ? "yes" : "no: " a " " b }'
}
values="SELECT job.id AS job, member, a.value AS angle, m.value AS mass FROM job
  JOIN metric a ON a.job_id = job.id AND a.name = 'bending_angle_deg'
  JOIN metric m ON m.job_id = job.id AND m.name = 'mass_g' WHERE study_id = 100"

# ---- ranking
fetch GET "$at/ranking?criteria=max:bending_angle_deg:3,min:mass_g:1&limit=57"
check "ranking" 200 "$CODE"
check "the order is that of the formula" "$(sql "WITH v AS ($values) SELECT group_concat(job) FROM (SELECT job,
  0.75 * (angle - (SELECT min(angle) FROM v)) / (SELECT max(angle) - min(angle) FROM v) +
  0.25 * ((SELECT max(mass) FROM v) - mass) / (SELECT max(mass) - min(mass) FROM v) AS score FROM v ORDER BY score DESC, job)")" \
  "$(field '[.designs[].job] | join(",")')"
check "failed members are counted" '[57,3,0.75]' "$(field '[.compared, .excluded, .criteria[0].weight]')"
check "titles and units" '["Mass","g","min"]' "$(field '.criteria[1] | [.title, .unit, .direction]')"
fetch GET "$at/ranking?preset=taper"
check "the ranking of its document is there when a study has ended" '409 conflict' "$CODE $(field .code)"
fetch GET '/api/v1/studies/310/ranking?preset=taper'
check "the formula of the paper" '["taper",[312,311],[0.785,0.07],[0.8,0.75],0.7]' \
  "$(field '[.preset, [.designs[].job], [.designs[].score], .designs[0].parts, .criteria[0].weight]')"

# ---- fronts
fetch GET "$at/pareto?objectives=max:bending_angle_deg,min:mass_g&layers=2"
first="SELECT v.job FROM v WHERE NOT EXISTS (SELECT 1 FROM v w WHERE w.angle >= v.angle AND w.mass <= v.mass
  AND (w.angle > v.angle OR w.mass < v.mass))"
check "the first layer is what nothing beats" "$(sql "WITH v AS ($values) SELECT group_concat(job) FROM ($first ORDER BY job)")" \
  "$(field '[.designs[] | select(.layer == 1) | .job] | sort | join(",")')"
check "two layers" 2 "$(field '.layers | length')"
area=$(sql "WITH v AS ($values), f AS (SELECT DISTINCT angle, mass FROM v WHERE job IN ($first)),
  r AS (SELECT min(angle) AS a, max(mass) AS m FROM v),
  s AS (SELECT angle - lag(angle, 1, (SELECT a FROM r)) OVER (ORDER BY angle) AS width, mass FROM f)
  SELECT sum(width * ((SELECT m FROM r) - mass)) FROM s")
check "the hypervolume is the area of the steps" yes "$(near "$(field .hypervolume.value)" "$area" 1e-6)"
check "exactly" true "$(field .hypervolume.exact)"

# ---- by the surrogate: an additive function, of which everything is known
fetch GET "$at/importance?metric=bending_angle_deg"
# variances: 400 / 12, 200 / 3, 200 / 3
check "the share of the wall" yes "$(near "$(field '.parameters[] | select(.title == "side wall") | .first.value')" 0.2 0.02)"
check "the share of the material" yes "$(near "$(field '.parameters[] | select(.key == "/material") | .total.value')" 0.4 0.02)"
check "an interval" true "$(field '.parameters[0].first | .low < .value and .value < .high')"
check "words have no correlation" null "$(field '.parameters[] | select(.key == "/material") | .pearson')"
check "the surrogate says what it is" '["Gaussian process, Matern 5/2",57,57,60]' \
  "$(field '.surrogate | [.method, .points, .succeeded, .members]')"
fetch GET "$at/effects?metric=bending_angle_deg"
check "main effect of the wall" yes "$(near "$(field '.main[0].mean | .[0] - .[-1]')" 20 0.2)"
check "main effect of the material by word" '["elastic-50a","dragon-skin-20","dragon-skin-30"]' "$(field '.main[2].at')"
check "whole numbers only" true "$(field '.main[1].at == [10, 11, 12]')"
check "no interactions" true "$(field '[.pairs[].share.value | fabs < 0.03] | all')"
fetch GET "$at/effects?metric=mass_g"
check "mass: chambers and walls interact" '["/actuator/side_wall","/actuator/chambers/0/count"]' "$(field '.pairs[0].keys')"
fetch GET "$at/surrogate?metric=bending_angle_deg"
check "it fits" true "$(field '.surrogate.r2 > 0.999')"
check "every point left out" '[57,57,"flags",3]' \
  "$(field '[(.left_out.predicted | length), (.left_out.jobs | length), .parameters[2].coding, (.parameters[2].lengths | length)]')"
fetch GET "$at/slice?metric=bending_angle_deg&x=/actuator/side_wall&y=/material&resolution=5&at./actuator/chambers/0/count=12"
check "a slice" '[3,5,3,5,true]' "$(field '[(.mean | length), (.mean[0] | length), (.deviation | length), (.deviation[0] | length),
  .at == {"/actuator/chambers/0/count": 12}]')"
check "its corner" yes "$(near "$(field '.mean[2][4]')" 140 0.5)"
fetch GET "$at/slice?metric=mass_g&x=/actuator/chambers/0/count"
check "a line" '[null,1,33]' "$(field '[.y, (.mean | length), (.mean[0] | length)]')"

# ---- search: with 10 chambers of the first material the angle is 160 - 20 s, which leaves s up to
# 0.25; the constraint leaves 0.1 or more: the least mass is 11
query="where=bending_angle_deg>=155,/actuator/side_wall<=2.4&least=mass_g&limit=3"
fetch GET "$at/search?$query"
check "members that meet the limits" "$(sql "WITH v AS ($values) SELECT count(*) FROM v JOIN study_value s ON s.study_id = 100
  AND s.member = v.member AND s.position = 0 WHERE angle >= 155 AND number <= 2.4")" "$(field .meeting)"
check "the best of them" "$(sql "WITH v AS ($values) SELECT job FROM v JOIN study_value s ON s.study_id = 100
  AND s.member = v.member AND s.position = 0 WHERE angle >= 155 AND number <= 2.4 ORDER BY mass LIMIT 1")" "$(field '.stored[0].job')"
check "stored ones are no predictions" '[false,null]' "$(field '.stored[0] | [.predicted, .metrics[0].deviation]')"
check "the constraint of the study holds" true "$(field '[.predicted[].values["/actuator/side_wall"] >= 1.6] | all')"
check "the best prediction" '[true,true,true]' "$(field '.predicted[0] | [.values["/actuator/chambers/0/count"] == 10, .predicted, .meets]')"
check "its mass" yes "$(near "$(field '.predicted[0].metrics[0].value')" 11 0.15)"
check "its job" '["elastic-50a","fast","100",null]' \
  "$(field '.predicted[0] | [.document.material, .document.accuracy, .document.labels.study, .solved]')"
design=$(field '{ values: .predicted[0].values }')
fetch POST "$at/confirm" --data-binary "$design"
check "a design is confirmed by a job" '202 100' "$CODE $(field .labels.study)"
job=$(field .id)
wait_state "$job" succeeded > /dev/null
fetch GET "$at/search?$query&chance=0.6"
check "which the search knows then" "[$job,\"succeeded\",3.5]" "$(field '.predicted[0].solved | [.job, .state, .metrics[0].value]')"
fetch POST "$at/confirm" -H 'Prefer: wait=10' --data-binary "$design"
check "once more is answered by that one" "200 $job" "$CODE $(field .reused_from)"
fetch POST "$at/confirm" --data-binary '{ "values": { "/actuator/side_wall": "2.1 mm", "/material": "dragon-skin-30" }, "name": "mine" }'
check "texts as in a job" '"mine"' "$(field '.name | tojson')"
fetch GET "$at/search?most=bending_angle_deg&where=/actuator/side_wall>=2"
check "the other way" yes "$(near "$(field '.predicted[0].metrics[0].value')" 170 0.5)"
fetch GET "$at/search?where=bending_angle_deg>=500&least=mass_g"
check "what cannot be reached" '[0,[],false]' "$(field '[.meeting, .stored, .predicted[0].meets]')"

# ---- tables
curl -s "$URL$at/export.csv" > "$WORK/table.csv"
check "RFC 4180" '61 61' "$(wc -l < "$WORK/table.csv") $(grep -c $'\r$' "$WORK/table.csv")"
check "names" 'member,job,state,reason,name,/actuator/side_wall [mm],/actuator/chambers/0/count,/material,bending_angle_deg,mass_g' \
  "$(head -1 "$WORK/table.csv" | tr -d '\r')"
check "quotes" '4,105,succeeded,,"wall ""4"", material 1",' "$(sed -n 6p "$WORK/table.csv" | cut -c 1-42)"
check "a failed member" '59,160,failed,diverged,' "$(tail -1 "$WORK/table.csv" | cut -c 1-23)"
sqlite3 "$WORK/read.db" ".import --csv $WORK/table.csv t"
check "another program reads the same" "$(sql "SELECT round(sum(value), 6) FROM metric JOIN job ON job.id = job_id WHERE study_id = 100 AND metric.name = 'mass_g'")" \
  "$(sqlite3 "$WORK/read.db" 'SELECT round(sum(mass_g), 6) FROM t')"
fetch GET "$at/export.csv?format=table"
check "the same on request" "$(tr -d '\r' < "$WORK/table.csv" | md5sum)" "$(tr -d '\r' < "$WORK/body" | md5sum)"
check "a formula is none" "0,321,succeeded,,'=SUM(A1)" "$(curl -s "$URL/api/v1/studies/320/export.csv" | tail -1 | tr -d '\r')"
check "nor for Optuna" 1 "$(curl -s "$URL/api/v1/studies/320/export.csv?format=optuna" | grep -cF ",'=SUM(A1),")"
curl -s "$URL$at/export.csv?format=optuna" > "$WORK/trials.csv"
check "columns of Optuna" 'number,value,datetime_start,datetime_complete,duration,params_/actuator/side_wall,params_/actuator/chambers/0/count,params_/material,user_attrs_mass_g,user_attrs_job,user_attrs_name,user_attrs_reason,state' \
  "$(head -1 "$WORK/trials.csv" | tr -d '\r')"
check "a trial" '4,130' "$(sed -n 6p "$WORK/trials.csv" | cut -d, -f 1,2 | cut -d. -f 1 | sed 's/1[0-9][0-9]$/130/')"
check "its times" '2026-01-31 12:00:01.004000,2026-01-31 12:00:02.242000,0 days 00:00:01.238000' "$(sed -n 6p "$WORK/trials.csv" | cut -d, -f 3-5)"
check "its state" COMPLETE "$(sed -n 6p "$WORK/trials.csv" | tr -d '\r' | sed 's/.*,//')"
check "a failed trial has no value" '59,,' "$(tail -1 "$WORK/trials.csv" | cut -c 1-4)"
check "and its state" FAIL "$(tail -1 "$WORK/trials.csv" | tr -d '\r' | sed 's/.*,//')"
fetch GET "$at/export.csv?format=optuna&objectives=max:bending_angle_deg,min:mass_g"
check "several objectives" 'number,values_0,values_1,datetime_start' "$(head -1 "$WORK/body" | cut -d, -f 1-4)"

# ---- refusals
for query in 'ranking' 'ranking?criteria=bending_angle_deg' 'ranking?criteria=max:nothing' 'ranking?criteria=max:mass_g:-1' \
  'ranking?criteria=max:mass_g,min:mass_g' 'ranking?preset=taper&criteria=max:mass_g' 'ranking?preset=x' 'ranking?criteria=max:mass_g:x' \
  'pareto' 'pareto?objectives=max:' 'pareto?objectives=max:mass_g&layers=0' 'importance' 'importance?metric=nothing' 'effects' \
  'surrogate?metric=/material' 'slice?metric=mass_g' 'slice?metric=mass_g&x=/nothing' 'slice?metric=mass_g&x=/material&y=/material' \
  'slice?metric=mass_g&x=/material&at./actuator/side_wall=thick' 'slice?metric=mass_g&x=/actuator/side_wall&at./material=stone' \
  'search' 'search?least=mass_g&most=mass_g' 'search?least=/material' 'search?least=mass_g&where=mass_g' 'search?least=mass_g&where=mass_g>=' \
  'search?least=mass_g&where=mass_g=3' 'search?least=/actuator/side_wall' 'search?least=mass_g&chance=2' 'search?least=mass_g&limit=0' \
  'export.csv?format=xml' 'export.csv?objectives=max:mass_g' 'export.csv?format=optuna&objectives=x'; do
  fetch GET "$at/$query"
  check "refused: $query" '400 invalid_query' "$CODE $(field .code)"
done
fetch GET "$at/importance?metric=mass"
check_match "a refusal names what there is" 'bending_angle_deg, mass_g' "$(field .detail)"
for query in 'ranking?criteria=max:mass_g' 'pareto?objectives=max:mass_g' 'importance?metric=mass_g' 'effects?metric=mass_g' \
  'surrogate?metric=mass_g' 'slice?metric=mass_g&x=/material' 'search?least=mass_g' export.csv; do
  fetch GET "/api/v1/studies/101/$query"
  check "a job that is no study: $query" '404 not_found' "$CODE $(field .code)"
done
fetch GET "/api/v1/studies/300/importance?metric=mass_g"
check "a study without members" 400 "$CODE"
fetch GET "/api/v1/studies/300/export.csv?format=optuna"
check "has an empty table" '200 1' "$CODE $(wc -l < "$WORK/body")"
fetch POST /api/v1/studies/101/confirm --data-binary '{ "values": {} }'
check "nothing to confirm" 404 "$CODE"
fetch POST "$at/confirm" --data-binary '{'
check "a body that is no JSON" 400 "$CODE"
for body in '{}' '{ "values": 3 }' '{ "values": {}, "name": 3 }' '{ "values": {}, "what": 1 }' '{ "values": { "/nothing": 1 } }' \
  '{ "values": { "/actuator/side_wall": "1 kPa" } }' '{ "values": { "/actuator/side_wall": 1e9 } }'; do
  fetch POST "$at/confirm" --data-binary "$body"
  check "refused: $body" 422 "$CODE"
done
head -c 1100000 /dev/zero | tr '\0' x > "$WORK/large"
fetch POST "$at/confirm" --data-binary "@$WORK/large"
check "too much" 413 "$CODE"
finish
