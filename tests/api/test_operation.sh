#!/bin/bash
# What an operator sees: logs, metrics, health, and what systemd is told.
. "$(dirname "$0")/lib.sh"
HERE=$(dirname "$0")
SOLVER=$(solver 'case $(jq -r .name "$job") in
  fails) result failed singular_tangent "no way on"; exit 3 ;;
  *) result succeeded ;;
esac')

# metrics_problems NAME...: what is wrong with /metrics, or which of these is not there.
metrics_problems() {
  curl -s "$URL/metrics" | python3 "$HERE/check_metrics.py" "$@"
}

# metric NAME{LABELS}: its value.
metric() {
  curl -s "$URL/metrics" | grep -v '^#' | grep -F -- "$1 " | sed 's/.* //'
}

NAMES="pneulab_jobs pneulab_workers pneulab_workers_busy pneulab_attempts_started_total
 pneulab_attempts_ended_total pneulab_worker_cpu_seconds_total pneulab_jobs_finished_total
 pneulab_solve_seconds pneulab_queue_wait_seconds pneulab_worker_peak_memory_bytes
 pneulab_isolation pneulab_database_write_seconds pneulab_database_write_wait_seconds_total
 pneulab_database_write_failures_total pneulab_database_size_bytes pneulab_http_requests_total
 pneulab_http_request_seconds pneulab_http_requests_aborted_total
 pneulab_http_response_bytes_total pneulab_http_connections pneulab_event_subscribers
 pneulab_disk_free_bytes pneulab_disk_size_bytes process_resident_memory_bytes
 process_open_fds process_max_fds process_cpu_seconds_total process_start_time_seconds
 pneulab_build_info"

# Log in JSON: every line is an object, whatever clients send.
start_daemon --workers 2 --solver "$SOLVER" --log-format json --log-level request
# shellcheck disable=SC2086
check "metrics before there was a job" "" "$(metrics_problems $NAMES)"
fetch POST /api/v1/jobs -H 'Prefer: wait=20' -H 'X-Request-Id: order-66' --data-binary "$(job)"
check "the id of the request comes back" order-66 "$(header X-Request-Id)"
fetch POST /api/v1/jobs -H 'Prefer: wait=20' --data-binary "$(job '.name = "fails"')"
check_match "without one there is a new one" '^[0-9a-f]{8}-[0-9]+$' "$(header X-Request-Id)"
fetch GET /healthz -H "X-Request-Id: $(printf 'a%.0s' $(seq 99))"
check_match "one that is too long is replaced" '^[0-9a-f]{8}-[0-9]+$' "$(header X-Request-Id)"
fetch GET '/x%0a{"level":"error"}%1b[31m?secret=1'
fetch GET "/$(printf '\303\251\377')\"quoted\"\\path"
fetch GET /api/v1/jobs/1
fetch DELETE /api/v1/jobs
sleep 0.2
lines=$(wc -l < "$WORK/stderr")
check "each line of the log is one JSON object" "$lines" "$(jq -c 'objects | select(.time and .level and .message)' "$WORK/stderr" | wc -l)"
check "no control characters" 0 "$(LC_ALL=C grep -c '[^ -~]' "$WORK/stderr")"
check "nobody forged an event" 0 "$(jq -c 'select(.level == "error")' "$WORK/stderr" | wc -l)"
check "a request" "POST /api/v1/jobs 200 true order-66" \
  "$(jq -r 'select(.message == "request" and .request == "order-66") | "\(.method) \(.path) \(.status) \(.duration_ms > 0 and .bytes > 100) \(.request)"' "$WORK/stderr")"
check "the job that came of it" 1 "$(jq -r 'select(.message == "job submitted" and .request == "order-66").job' "$WORK/stderr")"
check "its attempt" "1 1 response succeeded" \
  "$(jq -r 'select(.message == "attempt ended" and .job == 1) | "\(.job) \(.attempt) \(.kind) \(.state)"' "$WORK/stderr")"
check "a failure is a warning" "warning singular_tangent" \
  "$(jq -r 'select(.message == "attempt ended" and .job == 2) | "\(.level) \(.reason)"' "$WORK/stderr")"
check "queries are not logged" 0 "$(grep -c secret "$WORK/stderr")"

# Metrics.
# shellcheck disable=SC2086
check "metrics" "" "$(metrics_problems $NAMES)"
check "finished" "1 1" "$(metric 'pneulab_jobs_finished_total{kind="response",state="succeeded",reason=""}') $(metric 'pneulab_jobs_finished_total{kind="response",state="failed",reason="singular_tangent"}')"
check "states" "1 1 0" "$(metric 'pneulab_jobs{state="succeeded"}') $(metric 'pneulab_jobs{state="failed"}') $(metric 'pneulab_jobs{state="queued"}')"
check "solves" 2 "$(metric 'pneulab_solve_seconds_count{kind="response"}')"
check "waited" 2 "$(metric pneulab_queue_wait_seconds_count)"
check "requests by route" "1 2 1" "$(metric 'pneulab_http_requests_total{method="GET",route="/api/v1/jobs/{id}",status="2xx"}') $(metric 'pneulab_http_requests_total{method="POST",route="/api/v1/jobs",status="2xx"}') $(metric 'pneulab_http_requests_total{method="GET",route="/healthz",status="2xx"}')"
check "those that wait are no latency" 0 "$(metric 'pneulab_http_request_seconds_count{method="POST",route="/api/v1/jobs"}')"
check_match "transactions" '^[1-9]' "$(metric pneulab_database_write_seconds_count)"
check_match "the database's size" '^[1-9][0-9]{3}' "$(metric 'pneulab_database_size_bytes{file="main"}')"
before=$(metric pneulab_http_requests_aborted_total)
exec 3<> "/dev/tcp/127.0.0.1/$PORT"
printf 'POST /api/v1/jobs HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100\r\n\r\nhalf' >&3
sleep 0.2
exec 3>&-
check "an aborted request counts as such" $((before + 1)) \
  "$(for _ in $(seq 50); do n=$(metric pneulab_http_requests_aborted_total); [ "$n" != "$before" ] && break; sleep 0.1; done; echo "$n")"

# Ready, and why not.
fetch GET /readyz
check "ready" "200 ready" "$CODE $(field .status)"
mv "$SOLVER" "$SOLVER.away"
fetch GET /readyz
check "no solver" "503 workers" "$CODE $(field .code)"
check_match "it is named" "$SOLVER" "$(field .detail)"
fetch GET /healthz
check "alive all the same" 200 "$CODE"
mv "$SOLVER.away" "$SOLVER"
fetch GET /readyz
check "ready again" 200 "$CODE"
stop_daemon TERM

# Text, quiet, and under systemd.
: > "$WORK/stderr"
start_daemon --solver "$SOLVER" --log-level error
fetch GET /nothing
fetch POST /api/v1/jobs -H 'Prefer: wait=20' --data-binary "$(job '.name = "fails"')"
stop_daemon TERM
check "errors only: nothing to tell" "" "$(cat "$WORK/stderr")"
JOURNAL_STREAM=$(stat -c %d:%i "$WORK/stderr")
export JOURNAL_STREAM
export NOTIFY_SOCKET=$WORK/notify WATCHDOG_USEC=200000
python3 -c '
import socket, sys
s = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
s.bind(sys.argv[1])
while True:
    print(s.recv(4096).decode(), flush=True)' "$NOTIFY_SOCKET" > "$WORK/notified" &
listener=$!
until [ -S "$NOTIFY_SOCKET" ]; do sleep 0.05; done
start_daemon --solver "$SOLVER" --log-level request
unset WATCHDOG_USEC NOTIFY_SOCKET JOURNAL_STREAM
fetch POST /api/v1/jobs -H 'Prefer: wait=20' --data-binary "$(job '.name = "fails"')"
fetch GET '/x%0a<3>forged="1"'
sleep 0.5
stop_daemon TERM
kill $listener
check_match "systemd hears" '^READY=1 (WATCHDOG=1 )+STOPPING=1 $' "$(tr '\n' ' ' < "$WORK/notified")"
check "each line has its priority" 0 "$(grep -Evc '^<[3-6]>20[0-9-]+T[0-9:.]+Z (error|warning|info|request) ' "$WORK/stderr")"
check_match "fields of text" '^<4>.* warning attempt ended job=[0-9]+ attempt=1 kind=response state=failed reason=singular_tangent wall_s=' "$(grep 'attempt ended' "$WORK/stderr")"
check "a strange path is quoted" 1 "$(grep -cF 'method=GET path="/x%0a<3>forged=\"1\"" status=400' "$WORK/stderr")"
finish
