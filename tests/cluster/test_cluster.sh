#!/bin/bash
# Jobs on a Slurm cluster of two nodes: studies with the same numbers as on this machine, cancelling,
# holding, priorities, limits of time.
# shellcheck disable=SC2016,SC2317 # bodies of the stand-in, functions called by name
. "$(dirname "$0")/lib.sh"

# ---- the same numbers ------------------------------------------------------------------------

# bodies: four small ones.
bodies() {
  jq -nc '{ kind: "study", name: "bodies",
    base: { kind: "response",
      actuator: { family: "pneunet", length: "24 mm", width: "20 mm", height: "14 mm",
        chambers: [ { config: "B", count: 2 } ],
        side_wall: "2 mm", top_wall: "2 mm", bottom_layer: "4 mm" },
      material: "dragon-skin-20", load: { pressure: { to: "4 kPa", steps: 1 } },
      contact: false, error_estimate: false, timeout: "5 min",
      mesh: { gap_wall: 1, cavity: 1, gap: 1, half_width: 1, side_wall: 1, bottom: 1, height: 1, top: 1 } },
    sampling: "grid",
    parameters: [ { pointer: "/actuator/top_wall", values: [ "2 mm", "2.2 mm" ] },
      { pointer: "/actuator/side_wall", values: [ "2 mm", "2.1 mm" ] } ] }'
}

# numbers: every metric and sample of every member, to the last bit.
numbers() {
  sql "select name, member, metric, value from (
         select study.name as name, job.member as member, metric.name as metric,
           printf('%!.17g', metric.value) as value
         from metric join job on job.id = metric.job_id join job as study on study.id = job.study_id
         union all
         select study.name, job.member, sample.step || ' ' || sample.name, printf('%!.17g', sample.value)
         from sample join job on job.id = sample.job_id join job as study on study.id = job.study_id)
       order by 1, 2, 3"
}

start_daemon --memory-limit "$limit" --workers 2 --solver "$BIN/pneulab-solve"
first=$(submit "$(light_study light 40)") second=$(submit "$(bodies)")
check "light ones, here" succeeded "$(wait_state "$first" 'succeeded|failed|timed_out' 300)"
check "bodies, here" succeeded "$(wait_state "$second" 'succeeded|failed|timed_out' 300)"
numbers > "$WORK/here"
stop_daemon TERM

DATA=$WORK/shared
start_on_cluster --solver "$BIN/pneulab-solve"
fetch GET /readyz
check "the daemon with a cluster is ready" 200 "$CODE"
first=$(submit "$(light_study light 40)") second=$(submit "$(bodies)")
check "light ones, there" succeeded "$(wait_state "$first" 'succeeded|failed|timed_out' 300)"
check "bodies, there" succeeded "$(wait_state "$second" 'succeeded|failed|timed_out' 300)"
numbers > "$WORK/there"
check "as many numbers" "$(wc -l < "$WORK/here")" "$(wc -l < "$WORK/there")"
check "the same, to the last bit" "" "$(diff "$WORK/here" "$WORK/there" | head -n 4)"
check "light members share tasks" true \
  "$(awk '/JobId=/ { tasks++ } END { print (tasks > 0 && tasks < 44) ? "true" : "tasks: " tasks }' "$CLUSTER/log/completed")"
check "every member was tried once" "1 1" \
  "$(sql "select min(attempt) || ' ' || max(attempt) from job where study_id in ($first, $second)")"
check "and is a job with files of its own" 44 "$(find "$DATA/attempts" -mindepth 2 -name result.json -size +0 | wc -l)"
stop_daemon TERM

# ---- the queue ---------------------------------------------------------------------------------

# What a job does is in its name; "go-NAME" lets it end.
DATA=$WORK/queue
SOLVER=$(solver '
name=$(jq -r .name "$job")
echo "$name" >> "'"$WORK"'/order"
echo $$ > "'"$WORK"'/pid-$name"
case $name in
  waits*) until [ -e "'"$WORK"'/go-$name" ]; do sleep 0.05; done; result succeeded ;;
  late) trap "" TERM; while :; do sleep 0.05; done ;;
  *) result succeeded ;;
esac')
# Slurm knows no priority above that of a plain task: room for higher ones is made by standing back.
start_on_cluster --timeout-margin 1 --slurm-nice 2000 --solver "$SOLVER"

# small [JQ EDIT]: a job that costs nothing.
small() {
  jq -nc '{ kind: "verify", case: "patch-test" } | '"${1:-.}"
}

# All four processors of the cluster are taken.
taken=()
for i in 1 2 3 4; do taken+=("$(submit "$(small ".name = \"waits-$i\" | .timeout = \"90 s\"")")"); done
for id in "${taken[@]}"; do check "a job runs" running "$(wait_state "$id" running)"; done
check_match "Slurm ends what the daemon does not, soon after the job's own limit" '^[2-6]:[0-9][0-9]$' \
  "$(squeue -h -t running -o %l | sort -u)"
low=$(submit "$(small '.priority = -3 | .name = "low"')")
plain=$(submit "$(small '.name = "plain"')")
high=$(submit "$(small '.priority = 5 | .name = "high"')")
held=$(submit "$(small '.name = "held"')")
raised=$(submit "$(small '.priority = -100 | .name = "raised"')")
gone=$(submit "$(small '.name = "gone"')")
sleep 2
for id in "$low" "$plain" "$high" "$held" "$raised" "$gone"; do
  check_match "one without a processor waits" "^(queued|starting)\$" "$(wait_state "$id" "queued|starting" 1)"
done
fetch PATCH "/api/v1/jobs/$raised" --data-binary '{"priority": 100}'
check "its priority is raised" "200 100" "$CODE $(field .priority)"
fetch POST "/api/v1/jobs/$held/hold"
check "one is held" "200 held" "$CODE $(field .state)"
fetch POST "/api/v1/jobs/$gone/cancel"
check_match "one is cancelled" '^20[02] cancell(ed|ing)$' "$CODE $(field .state)"
check "at once" cancelled "$(wait_state "$gone" cancelled 5)"
touch "$WORK/go-waits-1"
for id in "$raised" "$high" "$plain" "$low"; do
  check "they have their turn" succeeded "$(wait_state "$id" succeeded)"
done
check "in the order of their priorities" "raised high plain low" \
  "$(grep -v waits "$WORK/order" | paste -sd' ')"
check "but for the one that is held" held "$(wait_state "$held" held 1)"
fetch POST "/api/v1/jobs/$held/release"
check "which is released" 200 "$CODE"
check "and has its turn" succeeded "$(wait_state "$held" succeeded)"

# Cancelling one that runs; the full run of this is in tests/reliability.
pid=$(cat "$WORK/pid-waits-2")
before=$(milliseconds)
fetch POST "/api/v1/jobs/${taken[1]}/cancel" -H 'Prefer: wait=30'
check "one that runs is cancelled" cancelled "$(wait_state "${taken[1]}" cancelled 30)"
check "its process with it" gone "$(wait_for 30 gone "$pid")"
echo "cancelled within $(($(milliseconds) - before)) ms"
check "nothing of it is left in Slurm" 2 "$(wait_for 30 tasks_are 2)"
fetch POST /api/v1/jobs -H 'Prefer: wait=60' --data-binary "$(small '.name = "late" | .timeout = "1 s"')"
check "a limit of time holds" "timed_out timeout" "$(field '"\(.state) \(.reason_code)"')"
touch "$WORK"/go-waits-{3,4}
for id in "${taken[@]:2}"; do check "the others end well" succeeded "$(wait_state "$id" succeeded)"; done
finish
