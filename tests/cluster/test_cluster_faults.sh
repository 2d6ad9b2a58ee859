#!/bin/bash
# A Slurm cluster that is down at the start, when jobs are submitted and while they run; a daemon
# that is killed meanwhile; a task and a node that are lost. Jobs wait and say why, the API answers,
# all goes on by itself, and every job has one result.
# shellcheck disable=SC2016,SC2317 # bodies of the stand-in, functions called by name
export CLUSTER_CONF="SlurmdTimeout=6
MessageTimeout=4
BatchStartTimeout=2"
. "$(dirname "$0")/lib.sh"

# What a job does is in its name; "go-NAME" lets it end. Every start is written down.
SOLVER=$(solver '
name=$(jq -r .name "$job")
folder=$(dirname "$job")
echo "${folder##*/} $$ ${SLURMD_NODENAME:-}" >> "'"$WORK"'/started"
case $name in
  waits*) until [ -e "'"$WORK"'/go-$name" ]; do sleep 0.05; done; result succeeded ;;
  *) sleep 0.3; result succeeded ;;
esac')
: > "$WORK/started"
small() {
  jq -nc '{ kind: "verify", case: "patch-test" } | '"${1:-.}"
}
# reason ID: words of the cluster in what is said of a job.
reason() {
  curl -s "$URL/api/v1/jobs/$1" | jq -r '.. | strings' | grep -iE 'slurm|cluster' | head -n 1
}
# node_of ID, pid_of_job ID: where its latest attempt has started.
node_of() {
  grep "^$1-" "$WORK/started" | tail -n 1 | cut -d' ' -f3
}
pid_of_job() {
  grep "^$1-" "$WORK/started" | tail -n 1 | cut -d' ' -f2
}

# ---- down at the start -----------------------------------------------------------------------

"$HERE/cluster_down.sh" "$CLUSTER" slurmctld
start_on_cluster --retry-delay 0 --solver "$SOLVER"
fetch GET /healthz
check "the daemon starts without its cluster" 200 "$CODE"
early=$(submit "$(small '.name = "early"')")
check_match "jobs are taken, wait, and say why" . "$(wait_for 30 reason "$early")"
check "in the queue" queued "$(wait_state "$early" queued 1)"
"$HERE/cluster_up.sh" "$CLUSTER" slurmctld
check "they go on by themselves" succeeded "$(wait_state "$early" succeeded)"

# ---- down while jobs run ----------------------------------------------------------------------

runs=$(submit "$(small '.name = "waits-1"')")
check "one runs" running "$(wait_state "$runs" running)"
# In order: what a slurmctld has taken in the last five seconds is lost when it is killed.
"$HERE/cluster_down.sh" "$CLUSTER" slurmctld
later=$(submit "$(small '.name = "later"')")
check_match "one that comes meanwhile waits, and says why" . "$(wait_for 30 reason "$later")"
fetch GET "/api/v1/jobs?limit=5"
check "the API answers" 200 "$CODE"
touch "$WORK/go-waits-1"
check "what the running one brought is taken in" succeeded "$(wait_state "$runs" succeeded)"
"$HERE/cluster_up.sh" "$CLUSTER" slurmctld
check "the other one follows" succeeded "$(wait_state "$later" succeeded)"

# ---- the daemon is killed ---------------------------------------------------------------------

running=()
for i in 2 3 4 5; do running+=("$(submit "$(small ".name = \"waits-$i\"")")"); done
for id in "${running[@]}"; do check "a job runs" running "$(wait_state "$id" running)"; done
waiting=()
for i in 6 7 8; do waiting+=("$(submit "$(small ".name = \"after-$i\"")")"); done
sleep 2
stop_daemon KILL
touch "$WORK/go-waits-2" # ends while no daemon is there
sleep 1
start_on_cluster --retry-delay 0 --solver "$SOLVER"
check "what ended meanwhile is taken in" succeeded "$(wait_state "${running[0]}" succeeded)"
check "what runs is adopted" running "$(wait_state "${running[1]}" running)"
touch "$WORK"/go-waits-{3,4,5}
for id in "${running[@]}" "${waiting[@]}"; do
  check "all end" succeeded "$(wait_state "$id" succeeded)"
done
check "nothing was submitted twice" "" \
  "$(for id in "${running[@]}" "${waiting[@]}"; do grep "^$id-" "$WORK/started"; done | cut -d' ' -f1 | sort | uniq -d)"
check "nor tried twice" 1 \
  "$(sql "select max(attempt) from job where id in ($(IFS=,; echo "${running[*]},${waiting[*]}"))")"

# ---- a task and a node are lost ---------------------------------------------------------------

lost=$(submit "$(small '.name = "waits-9"')")
check "one runs" running "$(wait_state "$lost" running)"
kill -KILL "$(wait_for 30 pid_of_job "$lost")"
second_try() {
  grep -c "^$lost-2 " "$WORK/started"
}
check "a lost task is tried again" 1 "$(wait_for 60 second_try)"
node=$(node_of "$lost")
"$HERE/cluster_down.sh" --kill "$CLUSTER" "$node"
third_try() {
  grep -c "^$lost-3 " "$WORK/started"
}
check "so is one whose node is lost" 1 "$(wait_for 90 third_try)"
check "on the other node" "$([ "$node" = n1 ] && echo n2 || echo n1)" "$(node_of "$lost")"
"$HERE/cluster_up.sh" "$CLUSTER" "$node"
touch "$WORK/go-waits-9"
check "in the end it succeeds" "succeeded 3" \
  "$(wait_state "$lost" 'succeeded|failed') $(sql "select attempt from job where id = $lost")"
check "every job has one result" "" \
  "$(sql "select job.id from job left join result on job.id = result.job_id and job.attempt = result.attempt where result.job_id is null")"
check "no attempt was started twice" "" "$(cut -d' ' -f1 "$WORK/started" | sort | uniq -d)"
finish
