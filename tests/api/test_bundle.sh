#!/bin/bash
# Members of a study that are solved in one process: results as they come, crashes, limits and
# cancellations of single members, the end of the daemon.
. "$(dirname "$0")/lib.sh"

# The stand-in does what the name of the member's mass says, once where a file `again` is there.
solver '[[ $(< "$job") =~ \"mass\":\ \"([0-9]+) ]]
again=$WORK/again-${BASH_REMATCH[1]}
case ${BASH_REMATCH[1]} in
  11) [ -e "$again" ] || { touch "$again"; kill -9 $$; } ;;
  12) kill -9 $$ ;;
  13) sleep 60 & echo $! > "$WORK/sleeper"; wait ;;
  14) exit 4 ;;
  15) echo "{\"status\":\"invalid\",\"error\":{\"message\":\"no such mass\"}}"; exit 2 ;;
esac
progress 0.5 1
sleep 0.02
result succeeded' > /dev/null
sed -i "2iWORK='$WORK'" "$WORK/solver"

# study MASS...: members of one chain after the other, eight times as many as are in a chain.
study() {
  jq -nc '{ kind: "study", name: "masses", sampling: "list",
    base: { kind: "hlpv", end: "1 s", sample_rate: "5 Hz", initial: { mode: "free" }, timeout: "2 s",
      model: { mass: "60 g", gamma: "5.577 N/psi",
        modes: { free: { stiffness: "2000 N/m", damping: "15 N s/m", alpha: "-9 1/s", beta: "9 1/s" } } },
      input: { hold: [["0 s", "3 psi"]] } },
    designs: [ $ARGS.positional[] | { set: { "/model/mass": (. + " g") } } ] }' --args "$@"
}

# states ID: members in each state.
states() {
  sql "select group_concat(n, ' ') from (select state || ':' || count(*) as n from job \
       where study_id = $1 group by state order by state)"
}

start_daemon --solver "$WORK/solver" --workers 1 --retry-delay 0 --timeout-margin 1

# Four chains of eight: the third member of the first dies once.
mapfile -t masses < <(seq 100 163)
masses[2]=11
id=$(submit "$(study "${masses[@]}")")
check "a study whose member crashes once succeeds" succeeded "$(wait_state "$id" 'succeeded|failed' 60)"
check "all its members have succeeded" "succeeded:64" "$(states "$id")"
check "they were solved in chains of eight" "8 8" \
  "$(sql "select count(*) || ' ' || max(n) from (select count(*) as n from job where study_id = $id group by chain)")"
crashed=$(sql "select id from job where study_id = $id and member = 2")
check "the crash counts for that member" "1 2 worker_killed" \
  "$(sql "select failures || ' ' || attempt || ' ' || (select reason_code from attempt where job_id = job.id and number = 1) from job where id = $crashed")"
check "those behind it went back into the queue" "5 not_begun" \
  "$(sql "select count(*) || ' ' || min(attempt.reason_code) from attempt join job on id = job_id where study_id = $id and outcome = 'requeued'")"
check "and were charged nothing" 1 "$(sql "select count(*) from job where study_id = $id and failures > 0")"
check "every member has its own files" 64 \
  "$(find "$DATA/attempts" -name result.json -path '*-*' | wc -l)"
check "the worker's word on its time is kept" 0.5 \
  "$(sql "select max(cpu_s) from attempt join job on id = job_id where study_id = $id")"
check "nothing of the bundles is left" 0 "$(find "$DATA/bundles" -mindepth 1 | wc -l)"

# Members that fail for good, each in its own way; one overruns its time.
mapfile -t masses < <(seq 200 231)
masses[1]=12 masses[5]=14 masses[9]=15 masses[13]=13
id=$(submit "$(study "${masses[@]}")")
check "failed members are data" succeeded "$(wait_state "$id" 'succeeded|failed' 60)"
check "all others have succeeded" "failed:3 succeeded:28 timed_out:1" "$(states "$id")"
check "each for its reason" "internal_error invalid_job timeout worker_killed" \
  "$(sql "select group_concat(reason_code, ' ') from (select reason_code from job where study_id = $id and reason_code <> '' order by 1)")"
check "what a worker says of a job is its message" "no such mass" \
  "$(sql "select message from job where study_id = $id and reason_code = 'invalid_job'")"

# Cancelled: a member while it is solved, and one that waits behind it.
mapfile -t masses < <(seq 300 331)
masses[0]=13
id=$(submit "$(study "${masses[@]}" | jq -c '.base.timeout = "60 s"')")
first=''
for _ in $(seq 200); do
  first=$(sql "select id from job where study_id = $id and member = 0 and state = 'running'")
  [ -n "$first" ] && break
  sleep 0.05
done
waiting=$(sql "select id from job where study_id = $id and member = 2")
check "what waits behind it is claimed" starting "$(sql "select state from job where id = $waiting")"
fetch POST "/api/v1/jobs/$waiting/cancel"
check "one that waits in the bundle is cancelled" cancelled "$(wait_state "$waiting" cancelled 20)"
check "without the one that runs" running "$(sql "select state from job where id = $first")"
fetch POST "/api/v1/jobs/$first/cancel"
check "so is the one that runs" cancelled "$(wait_state "$first" cancelled 20)"
check "the study goes on" succeeded "$(wait_state "$id" 'succeeded|failed' 60)"
check "with all others" "cancelled:2 succeeded:30" "$(states "$id")"

# The end of the daemon puts all of them back.
mapfile -t masses < <(seq 400 431)
masses[1]=13
id=$(submit "$(study "${masses[@]}" | jq -c '.base.timeout = "60 s"')")
for _ in $(seq 200); do
  [ -n "$(sql "select id from job where study_id = $id and member = 1 and state = 'running'")" ] && break
  sleep 0.05
done
check "what was done before is stored already" 1 \
  "$(sql "select count(*) from result join job on id = job_id where study_id = $id")"
stop_daemon TERM
check "no member is left in between" "queued:31 succeeded:1" "$(states "$id")"
start_daemon --solver "$WORK/solver" --workers 1
fetch POST "/api/v1/jobs/$id/cancel"
check "a study is cancelled as a whole" cancelled "$(wait_state "$id" cancelled 60)"
check "with all members that were left" 0 \
  "$(sql "select count(*) from job where study_id = $id and state not in ('succeeded', 'cancelled')")"
finish
