#!/bin/bash
# Studies as the API shows them: what they are, their designs as rows and columns, lists of their
# members, longer ones and repetitions.
. "$(dirname "$0")/lib.sh"

# A stand-in that knows the number of the mass, without its unit, and diverges where the damping is high.
solver 'text=$(< "$job")
[[ $text =~ \"mass\":\ \"([0-9.]+) ]]
mass=${BASH_REMATCH[1]}
status=succeeded reason= metrics="{\"heavy_g\":$mass,\"peak_speed_m_s\":1.5}"
[[ $text =~ \"damping\":\ \"19 ]] && status=diverged reason=diverged metrics={}
printf "{\"status\":\"%s\",\"reason\":\"%s\",\"message\":\"\",\"metrics\":%s,\"samples\":[],\"provenance\":{\"version\":\"0.1.0\"}}" \
  "$status" "$reason" "$metrics"
[ "$status" = succeeded ] || exit 3' > /dev/null
start_daemon --solver "$WORK/solver" --workers 2

# Two studies: of all combinations, and spread over a range.
base='{ "kind": "hlpv", "end": "1 s", "sample_rate": "5 Hz", "initial": { "mode": "free" },
  "model": { "mass": "60 g", "gamma": "5.577 N/psi", "modes": { "free": { "stiffness": "2000 N/m",
    "damping": "15 N s/m", "alpha": "-9 1/s", "beta": "9 1/s" } } },
  "input": { "hold": [["0 s", "3 psi"]] } }'
grid() {
  jq -nc --argjson base "$base" '{ kind: "study", name: "masses", sampling: "grid", base: $base,
    parameters: [ { pointer: "/model/mass", name: "mass", values: ["50 g", "0.06 kg", "70 g"] },
      { pointer: "/model/modes/free/damping", values: ["10 N s/m", "19 N s/m"] } ] }'
}
sobol() {
  jq -nc --argjson base "$base" '{ kind: "study", name: "sobol", sampling: "sobol", size: 8, base: $base,
    parameters: [ { pointer: "/model/mass", from: "50 g", to: "70 g" } ] }'
}

single=$(submit "$(job)")
id=$(submit "$(grid)")
check "it succeeds, since some members do" succeeded "$(wait_state "$id" 'succeeded|failed|timed_out' 60)"
fetch GET "/api/v1/studies/$id"
check "the study is there" "200 $id masses grid" "$CODE $(field '"\(.id) \(.name) \(.sampling)"')"
check "with its members" '6 6 {"succeeded":3,"failed":3}' \
  "$(field '"\(.members) \(.stored) \(.counts)"')"
check "failures by reason" "diverged 3 3" \
  "$(field '.failures[] | "\(.reason_code) \(.count) \(.jobs | length)"')"
check "its parameters, in the unit of the first value" "mass g 50 70,damping N s/m 10 19" \
  "$(field '[.parameters[] | "\(.title) \(.unit) \(.low) \(.high)"] | join(",")')"
check "its metrics" "heavy_g g,peak_speed_m_s m/s" "$(field '[.metrics[] | "\(.key) \(.unit)"] | join(",")')"
check "it cannot be extended" false "$(field .extendable)"
fetch GET "$(field .links.members)&limit=500"
check "its members are jobs" "6 0,1,2,3,4,5" \
  "$(field '"\(.jobs | length) \([.jobs[].member] | sort | map(tostring) | join(","))"')"
check "each names its study" "[\"/api/v1/studies/$id\"]" "$(field '[.jobs[].links.study] | unique')"
fetch GET "/api/v1/jobs?study=none&sort=id"
check "jobs of no study" "$single,$id" "$(field '[.jobs[].id | tostring] | join(",")')"
fetch GET "/api/v1/jobs?study=$id&state=failed&kind=hlpv&sort=name&limit=2"
check "members by state, kind and name" 2 "$(field '.jobs | length')"
fetch GET "/api/v1/jobs?study=last"
check "a study has a number" "400 invalid_query" "$CODE $(field .code)"

fetch GET "/api/v1/studies/$id/designs?sort=-/model/mass&limit=4"
check "rows, the heaviest first" "70,70,60,60 6 4" \
  "$(field '"\([.designs[].values["/model/mass"] | tostring] | join(",")) \(.stored) \(.next)"')"
fetch GET "/api/v1/studies/$id/designs?sort=-/model/mass&limit=4&cursor=4"
check "the rest" "50,50 null" \
  "$(field '"\([.designs[].values["/model/mass"] | tostring] | join(",")) \(.next)"')"
fetch GET "/api/v1/studies/$id/designs?sort=-heavy_g"
check "members without the metric come last" "70,50,0.06,null,null,null" \
  "$(field '[.designs[].metrics.heavy_g | tostring] | join(",")')"
fetch GET "/api/v1/studies/$id/designs?sort=colour"
check "an unknown column" "400 invalid_query" "$CODE $(field .code)"
fetch GET "/api/v1/studies/$id/designs?format=columns"
check "columns" "4 6 50,50,60,60,70,70" \
  "$(field '"\(.values | length) \(.jobs | length) \([.values[0][] | tostring] | join(","))"')"
check "null where there is none" "50,null,0.06,null,70,null" "$(field '[.values[2][] | tostring] | join(",")')"
check "states and reasons" "succeeded failed diverged" "$(field '"\(.states[0]) \(.states[1]) \(.reasons[1])"')"
fetch GET "/api/v1/studies/$id/designs?format=columns" -H "If-None-Match: $(header ETag)"
check "nothing new of a finished study" 304 "$CODE"
fetch GET "/api/v1/studies/$id/designs?format=table"
check "an unknown format" "400 invalid_query" "$CODE $(field .code)"
fetch GET "/api/v1/studies/$single"
check "another job is no study" 404 "$CODE"
fetch GET "/api/v1/studies/$id?format=columns"
check "the study has no format" "400 invalid_query" "$CODE $(field .code)"
check_match "why" format "$(field .detail)"
check "its view in the database" "60.0|0.06" \
  "$(sql "select mass_g, heavy_g from study_$id where state = 'succeeded' and mass_g = 60")"

# Its page, as those read it who have no scripts.
masses() { # of the rows of the page, in their order
  grep -o 'data-member="[0-9]*"' <<< "$BODY" | tr -dc '0-9\n' | while read -r job; do
    sql "select round(number) from study_value join job using (study_id, member) where job.id = $job and position = 0"
  done | cut -d. -f1 | paste -sd,
}
fetch GET "/studies/$id?sort=-/model/mass&page=1"
check "the heaviest first" "200 text/html 70,70,60,60,50,50" \
  "$CODE $(header Content-Type | cut -d';' -f1) $(masses)"
check "failures by reason, with their jobs" 3 \
  "$(grep 'data-reason="diverged"' <<< "$BODY" | grep -o 'href="/jobs/[0-9]*"' | wc -l)"
check "and the table for Optuna" 1 "$(grep -c "href=\"/api/v1/studies/$id/export.csv?format=optuna\"" <<< "$BODY")"
fetch GET "/studies/$id?sort=-/model/mass&page=1" -H "If-None-Match: $(header ETag)"
check "a page that is known is not sent again" "304 0" "$CODE ${#BODY}"
fetch GET "/studies/$id?page=0"
check "pages count from one" "400 text/html" "$CODE $(header Content-Type | cut -d';' -f1)"
fetch GET "/studies/$single"
check "another job has no such page" "404 text/html" "$CODE $(header Content-Type | cut -d';' -f1)"

# Longer ones.
fetch POST "/api/v1/studies/$id/extend" --data-binary '{"size": 20}'
check "a grid has no more members" 409 "$CODE"
for none in "$single" 4711 x; do
  fetch POST "/api/v1/studies/$none/extend" --data-binary '{"size": 20}'
  check "there is no study $none to extend" "404 not_found" "$CODE $(field .code)"
done
head -c 2000000 /dev/zero | tr '\0' ' ' > "$WORK/large"
fetch POST "/api/v1/studies/$id/extend" --data-binary "@$WORK/large"
check "a size does not take a megabyte" "413 too_large" "$CODE $(field .code)"
short=$(submit "$(sobol)")
wait_state "$short" succeeded > "$WORK/state"
fetch POST "/api/v1/studies/$short/extend" --data-binary '{"size": 8}'
check "more are more" "422 /size" "$CODE $(field .pointer)"
fetch POST "/api/v1/studies/$short/extend" --data-binary '{"members": 8}'
check "what more is has a name" 422 "$CODE"
fetch POST "/api/v1/studies/$short/extend" --data-binary '{"size": 12}'
check "it can have more" "202 $short" "$CODE $(field .extends)"
long=$(field .id)
check "the longer one" succeeded "$(wait_state "$long" 'succeeded|failed' 60)"
check "keeps the first members and solves the others" "0,1,2,3,4,5,6,7" \
  "$(sql "select group_concat(member) from (select member from job where study_id = $long and reused_from is not null order by member)")"
check "with the same values" 8 \
  "$(sql "select count(*) from study_$short as a join study_$long as b using (member, mass_g, heavy_g)")"

fetch POST "/api/v1/studies/$short/extend" -H 'Prefer: wait=60' --data-binary '{"size": 16}'
check "its end can be waited for" "200 succeeded $short wait=60" \
  "$CODE $(field '"\(.state) \(.extends)"') $(header Preference-Applied)"
check "it is a new one" "/api/v1/jobs/$(field .id)" "$(header Location)"
check "with all its members" 16 "$(sql "select count(*) from study_$(field .id)")"

# Trying again solves what has failed.
fetch POST "/api/v1/jobs/$id/retry"
again=$(field .id)
check "it can be tried again" "202 $id" "$CODE $(field .retry_of)"
check "to its end" succeeded "$(wait_state "$again" 'succeeded|failed' 60)"
check "only what has failed is solved again" "3 3" \
  "$(sql "select sum(reused_from is null) || ' ' || sum(state = 'failed') from job where study_id = $again")"
fetch DELETE "/api/v1/jobs/$id"
check "a study is deleted" 204 "$CODE"
for _ in $(seq 200); do
  [ "$(sql "select count(*) from study_deleted")" = 0 ] && break
  sleep 0.05
done
check "with its members and what it had in the database" "0 0 0" \
  "$(sql "select (select count(*) from job where study_id = $id) || ' ' || (select count(*) from study_value where study_id = $id) || ' ' || (select count(*) from sqlite_schema where name = 'study_$id')")"
fetch GET "/api/v1/studies/$id"
check "it is gone" 404 "$CODE"
finish
