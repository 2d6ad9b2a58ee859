#!/bin/bash
# The queue: priorities, shares of submitters, changes of jobs that wait, earlier answers, limits,
# cancelling in every state, attempts and their logs.
. "$(dirname "$0")/lib.sh"
# What a job does is in its name; "go-NAME" lets it end.
SOLVER=$(solver '
name=$(jq -r .name "$job")
echo "attempt of $name" >&2
case $name in
  waits*) until [ -e "'"$WORK"'/go-$name" ]; do sleep 0.02; done; result succeeded ;;
  stubborn) trap "" TERM; until [ -e "'"$WORK"'/go-$name" ]; do sleep 0.02; done; result succeeded ;;
  once) [ -e "'"$WORK"'/died" ] || { touch "'"$WORK"'/died"; kill -KILL $$; }; result succeeded ;;
  dies) kill -KILL $$ ;;
  nomem) echo "{\"status\":\"error\",\"error\":{\"code\":\"no_memory\",\"message\":\"no memory for 3 elements\"}}"; exit 4 ;;
  late) trap "" TERM; while :; do sleep 0.05; done ;;
  in-time) result diverged timeout "The time was over."; exit 3 ;;
  *) result succeeded ;;
esac')
start_daemon --workers 1 --retry-delay 0.1 --timeout-margin 0.1 --memory-limit 512 --solver "$SOLVER"

# small [JQ EDIT]: a job that costs nothing.
small() {
  jq -nc '{ kind: "verify", case: "patch-test" } | '"${1:-.}"
}
# order ID...: the ids in the order in which they started.
order() {
  sql "select job_id from attempt where job_id in ($(paste -sd, <<< "$(printf '%s\n' "$@")")) order by created_ms, job_id" | paste -sd' '
}
# all_ended ID...
all_ended() {
  for id; do wait_state "$id" 'succeeded|failed|timed_out|cancelled' > /dev/null; done
}

# Priorities and their changes.
first=$(submit "$(small '.name = "waits-1"')")
wait_state "$first" running > /dev/null
low=$(submit "$(small '.priority = -3 | .name = "low"')")
plain=$(submit "$(small '.name = "plain"')")
high=$(submit "$(small '.priority = 5 | .name = "high"')")
raised=$(submit "$(small '.priority = -100 | .name = "raised"')")
fetch PATCH "/api/v1/jobs/$raised" -H 'Content-Type: application/merge-patch+json' \
  --data-binary '{"priority": 100, "name": "first of all", "labels": {"a": "b", "c": "d"}}'
check "a patch" '200 100 "first of all" {"a":"b","c":"d"}' "$CODE $(printf '%s' "$BODY" | jq -c '.priority, .name, .labels' | paste -sd' ')"
fetch PATCH "/api/v1/jobs/$raised" --data-binary '{"labels": {"a": null}}'
check "null removes" '{"c":"d"}' "$(field .labels)"
check "the list knows the new label" "$raised" "$(curl -s "$URL/api/v1/jobs?label.c=d" | jq '.jobs[].id')"
check "and no longer the old one" "" "$(curl -s "$URL/api/v1/jobs?label.a=b" | jq '.jobs[].id')"
for wrong in '[]|422|' '{"priority": 101}|422|/priority' '{"priority": "x"}|422|/priority' '{"name": ""}|422|/name' \
  '{"labels": {"x": 3}}|422|/labels/x' '{"labels": []}|422|/labels' '{"labels": {"x": null, "y": 3}}|422|/labels/y' \
  '{"memory": "1 GB"}|422|/memory' '{|400|'; do
  IFS='|' read -r body code pointer <<< "$wrong"
  fetch PATCH "/api/v1/jobs/$raised" --data-binary "$body"
  check "the patch $body" "$code $pointer" "$CODE $(field .pointer)"
done
fetch PATCH "/api/v1/jobs/$first" --data-binary '{"priority": 1}'
check "the priority of a running job" "409 conflict" "$CODE $(field .code)"
fetch PATCH "/api/v1/jobs/$first" --data-binary '{"labels": {"seen": "yes"}}'
check "the labels of a running job" '200 {"seen":"yes"}' "$CODE $(field .labels)"
fetch PATCH "/api/v1/jobs/$first" --data-binary '{"name": null, "labels": null}'
check "null for all of it" '200  {}' "$CODE $(field .name) $(field .labels)"
fetch PATCH "/api/v1/jobs/4711" --data-binary '{}'
check "a patch of no job" 404 "$CODE"
touch "$WORK/go-waits-1"
all_ended "$low" "$plain" "$high" "$raised"
check "the order of priorities" "$raised $high $plain $low" "$(order "$low" "$plain" "$high" "$raised")"
fetch PATCH "/api/v1/jobs/$low" --data-binary '{"name": "x"}'
check "a finished job is not changed" "409 conflict" "$CODE $(field .code)"

# Shares: one submitter has many jobs, the others do not wait for them.
first=$(submit "$(small '.name = "waits-2" | .labels.user = "ann"')")
wait_state "$first" running > /dev/null
ann=()
for i in 1 2 3 4; do ann+=("$(submit "$(small ".labels.user = \"ann\" | .refinement = $i")")"); done
bob=$(submit "$(small '.labels.user = "bob"')")
eve=$(submit "$(small '.labels.user = "eve"')")
check "whose share" ann "$(curl -s "$URL/api/v1/jobs/${ann[0]}" | jq -r .submitter)"
touch "$WORK/go-waits-2"
all_ended "${ann[@]}" "$bob" "$eve"
check "bob and eve do not wait for all of ann's" "$bob $eve ${ann[*]}" "$(order "$bob" "$eve" "${ann[@]}")"

# Retries with a reason.
fetch POST "/api/v1/jobs/$high/retry" -H 'Prefer: wait=20' --data-binary '{"reason": "twice is better"}'
check "a succeeded job is solved again" "200 $high twice is better 5" "$CODE $(field '"\(.retry_of) \(.retry_reason) \(.priority)"')"
fetch POST "/api/v1/jobs/$raised/retry" -H 'Prefer: wait=20'
check "with what was changed by hand" 'first of all 100 {"c":"d"}' "$(field '"\(.name) \(.priority) \(.labels | tojson)"')"
for wrong in '{"why": 1}|422|/why' '{"reason": 3}|422|/reason' '[]|422|' 'x|400|' \
  "{\"reason\": \"$(printf 'x%.0s' {1..2000})\"}|422|/reason" '{"reason": "a", "why": 1}|422|/why'; do
  IFS='|' read -r body code pointer <<< "$wrong"
  fetch POST "/api/v1/jobs/$high/retry" --data-binary "$body"
  check "a retry with $body" "$code $pointer" "$CODE $(field .pointer)"
done

# Earlier answers. (The stand-in says that it is the version of the daemon.)
reused() { small '.name = "same" | .refinement = 2 | .case = "roll-up" | '"${1:-.}"; }
fetch POST /api/v1/jobs -H 'Prefer: wait=20' --data-binary "$(reused '.reuse = true')"
original=$(field .id)
check "the first one is solved" "succeeded null" "$(field '"\(.state) \(.reused_from)"')"
starts=$(sql "select count(*) from attempt where pid is not null")
fetch POST /api/v1/jobs --data-binary "$(reused '.reuse = true | .name = "copy" | .memory = "100 MB" | .priority = 9')"
copy=$(field .id)
check "an equal one is answered at once" "200 succeeded $original 64.25" "$CODE $(field '"\(.state) \(.reused_from) \(.metrics.bending_angle_deg)"')"
check "with links of its own" "/api/v1/jobs/$copy/artifacts/surface.json" "$(field '.links.artifacts[0]')"
check "no worker ran" "$starts" "$(sql "select count(*) from attempt where pid is not null")"
fetch GET "/api/v1/jobs/$copy/attempts"
check "its attempt says so" "1 reused null" "$(field '.attempts[] | "\(.number) \(.outcome) \(.pid)"')"
fetch POST /api/v1/jobs --data-binary "$(reused)"
check "without being asked it is solved" "202 null" "$CODE $(field .reused_from)"
fetch DELETE "/api/v1/jobs/$original"
check "the original can go" 204 "$CODE"
for part in result metrics samples.csv artifacts/surface.json log; do
  fetch GET "/api/v1/jobs/$copy/$part"
  check "the copy keeps its $part" 200 "$CODE"
done
check "result and samples are in the database" "1 4" "$(sql "select (select count(*) from result where job_id = $copy) || ' ' || (select count(*) from sample where job_id = $copy)")"
fetch POST "/api/v1/jobs/$copy/retry" -H 'Prefer: wait=20'
check "a retry is solved" "succeeded null" "$(field '"\(.state) \(.reused_from)"')"
# Many at the same time: one is solved.
first=$(submit "$(small '.name = "waits-3" | .reuse = true | .case = "elastica"')")
wait_state "$first" running > /dev/null
many=()
for _ in 1 2 3 4 5; do many+=("$(submit "$(small '.name = "waits-3" | .reuse = true | .case = "elastica"')")"); done
check "they wait for the one that runs" "$first" "$(curl -s "$URL/api/v1/jobs/${many[4]}" | jq .waits_for)"
curl -s -X POST "$URL/api/v1/jobs/${many[4]}/cancel" > /dev/null
touch "$WORK/go-waits-3"
all_ended "${many[@]}"
check "and are answered" "succeeded $first succeeded $first succeeded $first succeeded $first cancelled" \
  "$(for id in "${many[@]}"; do curl -s "$URL/api/v1/jobs/$id" | jq -r '"\(.state) \(.reused_from // "")"'; done | paste -sd' ' | sed 's/ *$//')"
check "one worker for all" 1 "$(sql "select count(*) from attempt where pid is not null and job_id >= $first")"

# Limits of a job.
fetch POST /api/v1/jobs --data-binary "$(small '.memory = "1 GiB"')"
check "more memory than the daemon's" "422 /memory" "$CODE $(field .pointer)"
fetch POST /api/v1/jobs:validate --data-binary "$(small '.memory = "1 GiB"')"
check "also when it is only checked" "422 /memory" "$CODE $(field .pointer)"
fetch POST /api/v1/jobs --data-binary "$(small '.memory = "1 GHz"')"
check "another unit" "422 /memory" "$CODE $(field .pointer)"
fetch POST /api/v1/jobs -H 'Prefer: wait=20' --data-binary "$(small '.name = "nomem" | .memory = "100 MB"')"
check "a solver that says so" "failed memory_limit 1" "$(field '"\(.state) \(.reason_code) \(.attempt)"')"
check_match "its message" '100 MB' "$(field .message)"
fetch POST /api/v1/jobs -H 'Prefer: wait=20' --data-binary "$(small '.name = "in-time" | .timeout = "1 s"')"
check "a solve that stops in time" "timed_out timeout 64.25" "$(field '"\(.state) \(.reason_code) \(.metrics.bending_angle_deg)"')"
late=$(submit "$(small '.name = "late" | .timeout = "1 s"')")

# Cancelling: in every state there is.
held=$(submit "$(small '.name = "held"')")
waiting=$(submit "$(small '.name = "queued"')")
curl -s -X POST "$URL/api/v1/jobs/$held/hold" > /dev/null
for id in "$held" "$waiting"; do
  fetch POST "/api/v1/jobs/$id/cancel"
  check "one that waits is cancelled at once" "200 cancelled cancel_requested" "$CODE $(field '"\(.state) \(.reason_code)"')"
  fetch POST "/api/v1/jobs/$id/cancel"
  check "once" "409 conflict" "$CODE $(field .code)"
done
check "a worker that does not stop in time is ended" timed_out "$(wait_state "$late" 'timed_out|failed' 20)"
stubborn=$(submit "$(small '.name = "stubborn"')")
wait_state "$stubborn" running > /dev/null
fetch POST "/api/v1/jobs/$stubborn/cancel"
check "one that runs" "202 cancelling" "$CODE $(field .state)"
fetch POST "/api/v1/jobs/$stubborn/cancel"
check "again" "202 cancelling" "$CODE $(field .state)"
fetch PATCH "/api/v1/jobs/$stubborn" --data-binary '{"priority": 3}'
check "its priority" 409 "$CODE"
fetch POST "/api/v1/jobs/$stubborn/hold"
check "holding it" 409 "$CODE"
touch "$WORK/go-stubborn"
check "what it brings is not taken" "cancelled 0" "$(wait_state "$stubborn" 'cancelled|succeeded') $(sql "select count(*) from result where job_id = $stubborn")"
stop_daemon TERM
start_daemon --workers 1 --retry-delay 30 --memory-limit 512 --solver "$SOLVER"
dies=$(submit "$(small '.name = "dies"')")
check "one that waits for its next attempt" retry_wait "$(wait_state "$dies" retry_wait)"
fetch PATCH "/api/v1/jobs/$dies" --data-binary '{"priority": 3}'
check "can be changed" "200 3" "$CODE $(field .priority)"
fetch POST "/api/v1/jobs/$dies/cancel"
check "and cancelled" "200 cancelled" "$CODE $(field .state)"
# Races: a cancel at any moment of a short job ends it one way or the other.
ids=()
pids=()
for i in $(seq 12); do
  id=$(submit "$(small '.name = "short"')")
  ids+=("$id")
  sleep "0.0$((i * 7 % 10))"
  curl -s -X POST -o /dev/null "$URL/api/v1/jobs/$id/cancel" &
  pids+=($!)
done
wait "${pids[@]}"
all_ended "${ids[@]}"
check "every one has ended" 0 "$(sql "select count(*) from job join job_state using (state) where terminal = 0")"
check "cancelled ones have no result, others have one" 0 "$(sql "select count(*) from job where id in ($(paste -sd, <<< "$(printf '%s\n' "${ids[@]}")")) and (state = 'succeeded') <> (select count(*) from result where job_id = job.id)")"
check "nothing is counted as running" 0 "$(sql "select coalesce(sum(running + ready), 0) from submitter")"
check "counts by state are right" 0 "$(sql "select count(*) from job_count where jobs <> (select count(*) from job where job.state = job_count.state)")"

# Attempts keep their reasons and logs.
rm -f "$WORK/died"
stop_daemon TERM
start_daemon --workers 2 --retry-delay 0.1 --solver "$SOLVER"
fetch POST /api/v1/jobs -H 'Prefer: wait=20' --data-binary "$(small '.name = "once"')"
once=$(field .id)
fetch GET "/api/v1/jobs/$once/attempts"
check "both attempts" "1 worker_lost worker_killed 9 null,2 succeeded  null 0" \
  "$(field '.attempts[] | "\(.number) \(.outcome) \(.reason_code) \(.signal) \(.exit_code)"' | paste -sd,)"
check "time and memory of both" true "$(field '[.attempts[] | .cpu_s >= 0 and .peak_memory_MB > 0 and .finished >= .started] | all')"
check_match "a sentence" 'Signal 9' "$(field '.attempts[0].message')"
for log in $(field '.attempts[].log'); do
  fetch GET "$log"
  check "the log $log" "attempt of once" "$BODY"
done

# Two workers, two submitters: each has one.
rm -f "$WORK"/go-*
a=$(submit "$(small '.name = "waits-a" | .labels.user = "ann"')")
b=$(submit "$(small '.name = "waits-b" | .labels.user = "ann"')")
wait_state "$a" running > /dev/null; wait_state "$b" running > /dev/null
c=$(submit "$(small '.name = "waits-c" | .labels.user = "ann"')")
d=$(submit "$(small '.name = "waits-d" | .labels.user = "bob"')")
touch "$WORK/go-waits-a"
check "the one without a worker is next" running "$(wait_state "$d" running)"
check "the other waits" queued "$(wait_state "$c" 'queued|running')"
touch "$WORK"/go-waits-{b,c,d}
all_ended "$a" "$b" "$c" "$d"
finish
