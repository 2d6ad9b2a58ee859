#!/bin/bash
# Cancelling, retrying, holding and deleting; time limits.
. "$(dirname "$0")/lib.sh"
start_daemon --workers 1 --retry-delay 0.1 --timeout-margin 0.5 --solver "$(solver '
case $(jq -r .name "$job") in
  stubborn) trap "" TERM; progress 0.25 12.5; while :; do sleep 0.1; done ;;
  long) trap "exit 5" TERM; progress 0.25 12.5; while :; do sleep 0.05; done ;;
  polite) trap "result diverged timeout \"Out of time.\"; exit 3" TERM; while :; do sleep 0.05; done ;;
  refused) echo "{\"status\":\"invalid\",\"error\":{\"code\":\"invalid_job\",\"message\":\"Not like this.\",\"pointer\":\"/load\"}}"; exit 2 ;;
  *) result succeeded ;;
esac')"

# Cancelling a running job, which leaves no worker behind.
long=$(submit "$(job '.name = "long"')")
queued=$(submit "$(job '.name = "queued behind it"')")
check "it runs" running "$(wait_state "$long" running)"
# wait_progress ID: until the worker has told of its progress, by when its traps are set.
wait_progress() {
  for _ in $(seq 200); do
    fetch GET "/api/v1/jobs/$1"
    [ "$(field .progress)" = 0.25 ] && break
    sleep 0.05
  done
}
wait_progress "$long"
check "progress is seen while it runs" 0.25 "$(field .progress)"
check "the other one waits" queued "$(wait_state "$queued" queued)"
fetch DELETE "/api/v1/jobs/$long"
check "a running job cannot be deleted" "409 conflict" "$CODE $(field .code)"
fetch POST "/api/v1/jobs/$long/retry"
check "nor retried" "409 conflict" "$CODE $(field .code)"
fetch POST "/api/v1/jobs/$queued/cancel"
check "a queued job is cancelled at once" "200 cancelled" "$CODE $(field .state)"
pid=$(sql "select pid from attempt where job_id = $long")
fetch POST "/api/v1/jobs/$long/cancel" -H 'Prefer: wait=20'
check "a running job is cancelled soon" "200 cancelled cancel_requested" "$CODE $(field '.state + " " + .reason_code')"
check "its worker is gone" no "$(alive "$pid")"
fetch POST "/api/v1/jobs/$long/cancel"
check "a cancelled job cannot be cancelled" "409 conflict" "$CODE $(field .code)"
check "no result of a cancelled job" 0 "$(sql "select count(*) from result where job_id = $long")"

# A worker that does not listen is killed after five seconds.
stubborn=$(submit "$(job '.name = "stubborn"')")
check "it runs" running "$(wait_state "$stubborn" running)"
wait_progress "$stubborn"
start=$SECONDS
fetch POST "/api/v1/jobs/$stubborn/cancel"
check "cancelling is accepted" "202 cancelling" "$CODE $(field .state)"
fetch POST "/api/v1/jobs/$stubborn/cancel"
check "asking twice is fine" 202 "$CODE"
check "it ends" cancelled "$(wait_state "$stubborn" cancelled)"
check "after about five seconds" true "$([ $((SECONDS - start)) -ge 4 ] && [ $((SECONDS - start)) -le 12 ] && echo true)"

# Retrying makes a new job of the same document.
fetch POST "/api/v1/jobs/$queued/retry" -H 'Prefer: wait=20'
again=$(field .id)
check "retry" "200 succeeded $queued" "$CODE $(field .state) $(field .retry_of)"
check "retry has a location" "/api/v1/jobs/$again" "$(header Location)"
check "the old job stays as it was" cancelled "$(wait_state "$queued" cancelled)"

# Holding.
blocker=$(submit "$(job '.name = "long"')")
wait_state "$blocker" running > /dev/null
held=$(submit)
fetch POST "/api/v1/jobs/$held/hold"
check "hold" "200 held" "$CODE $(field .state)"
fetch POST "/api/v1/jobs/$held/hold"
check "hold twice" "409 conflict" "$CODE $(field .code)"
fetch POST "/api/v1/jobs/$blocker/cancel" -H 'Prefer: wait=20'
sleep 0.7
check "a held job does not start" held "$(wait_state "$held" held 1)"
fetch POST "/api/v1/jobs/$held/release"
check "release" 200 "$CODE"
check "then it runs" succeeded "$(wait_state "$held" succeeded)"

# Deleting takes rows and files, and ids are not used again.
check "files are there" yes "$([ -d "$DATA/attempts/$held-1" ] && echo yes || echo no)"
fetch DELETE "/api/v1/jobs/$held"
check "delete" 204 "$CODE"
fetch GET "/api/v1/jobs/$held"
check "it is gone" 404 "$CODE"
check "so are its files" no "$([ -d "$DATA/attempts/$held-1" ] && echo yes || echo no)"
check "and its rows" 0 "$(sql "select (select count(*) from metric where job_id = $held) + (select count(*) from sample where job_id = $held) + (select count(*) from design_parameter where job_id = $held) + (select count(*) from attempt where job_id = $held) + (select count(*) from result where job_id = $held) + (select count(*) from artifact where job_id = $held)")"
check "ids go on" $((held + 1)) "$(submit)"

# Time limits.
late=$(submit "$(job '.name = "stubborn" | .timeout = "1 s"')")
check "an overrunning worker is ended" timed_out "$(wait_state "$late" 'timed_out|failed' 20)"
fetch GET "/api/v1/jobs/$late"
check "reason" timeout "$(field .reason_code)"
polite=$(submit "$(job '.name = "polite" | .timeout = "3 s"')")
check "a solve that stops in time" timed_out "$(wait_state "$polite" 'timed_out|failed' 20)"
fetch GET "/api/v1/jobs/$polite"
check "keeps what it has" "timeout 64.25" "$(field .reason_code) $(field .metrics.bending_angle_deg)"

# The solver has the last word on what is a job.
refused=$(submit "$(job '.name = "refused"')")
check "refused by the solver" failed "$(wait_state "$refused" 'failed|succeeded')"
fetch GET "/api/v1/jobs/$refused"
check "reason, sentence and place" "invalid_job Not like this. At /load" "$(field '.reason_code + " " + .message')"
check "no second attempt" 1 "$(field .attempt)"

# The state machine is kept by the database itself.
check_match "a terminal job cannot change" "illegal change" "$(sql "update job set state = 'queued' where id = $refused" 2>&1)"
check_match "nor get a second result" "UNIQUE" "$(sql "insert into result select job_id, attempt, document, directory, created_ms from result where job_id = $polite" 2>&1)"
finish
