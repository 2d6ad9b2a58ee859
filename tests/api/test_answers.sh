#!/bin/bash
# Answers of operations that the other tests have no need of: tests/contract asks for each once.
. "$(dirname "$0")/lib.sh"
start_daemon --workers 1 --solver "$(solver '
case $(jq -r .name "$job") in
  *sleepy*) sleep 60 ;;
  *) echo "a line of the log" >&2; result succeeded ;;
esac')"
id=$(submit)
wait_state "$id" succeeded > /dev/null

head -c 2097152 /dev/zero | tr '\0' ' ' > "$WORK/big"
fetch POST /api/v1/jobs:validate --data-binary "@$WORK/big"
check "2 MiB to check" "413 too_large" "$CODE $(field .code)"

fetch PATCH "/api/v1/jobs/$id" --data-binary "@$WORK/big"
check "2 MiB for a change" "413 too_large" "$CODE $(field .code)"
for path in /sign-in /sign-out "/api/v1/jobs/$id/retry"; do
  fetch POST $path --data-binary "@$WORK/big"
  check "2 MiB for $path" "413 too_large" "$CODE $(field .code)"
done

fetch GET '/sign-in?next=/jobs/1'
check "the form that leads to a job" 200 "$CODE"

fetch POST "/api/v1/jobs/$id/retry"
check "run again" "202 $id" "$CODE $(field .retry_of)"
check_match "where the new job is" '^/api/v1/jobs/[0-9]+$' "$(header Location)"
again=$(field .id)
wait_state "$again" succeeded > /dev/null
fetch POST "/api/v1/jobs/$id/retry" -H 'Prefer: wait=20'
check "run again and wait" "200 succeeded wait=20" "$CODE $(field .state) $(header Preference-Applied)"
sleepy=$(submit "$(job '.name = "sleepy"')")
wait_state "$sleepy" running > /dev/null
fetch POST "/api/v1/jobs/$sleepy/cancel" -H 'Prefer: wait=20'
check "cancelled; no new job is named" "200 cancelled " "$CODE $(field .state) $(header Location)"

for action in cancel retry hold release; do
  fetch POST "/api/v1/jobs/4711/$action"
  check "$action what is not there" "404 not_found" "$CODE $(field .code)"
done
for action in hold release; do
  fetch POST "/api/v1/jobs/$id/$action"
  check "$action what has ended" "409 conflict" "$CODE $(field .code)"
done
for path in jobs/4711/metrics "plots/overlay.png?jobs=$id,4711" "compare?jobs=4711"; do
  fetch GET "/api/v1/$path"
  check "GET $path" "404 not_found" "$CODE $(field .code)"
done

fetch GET "/api/v1/jobs/$id/log?attempt=1"
check "the log of the first attempt" "200 a line of the log" "$CODE $BODY"
for attempt in 0 2 x; do
  fetch GET "/api/v1/jobs/$id/log?attempt=$attempt"
  check "the log of attempt $attempt" "400 invalid_query" "$CODE $(field .code)"
done
fetch GET "/api/v1/plots/overlay.png?jobs=$id,$again&width=400&height=320"
check "a small overlay" "200 image/png" "$CODE $(header Content-Type)"
cp "$WORK/body" "$WORK/light"
fetch GET "/api/v1/plots/overlay.png?jobs=$id,$again&width=400&height=320&theme=dark"
check "a dark one is another picture" "200 image/png differs" \
  "$CODE $(header Content-Type) $(cmp -s "$WORK/light" "$WORK/body" && echo same || echo differs)"
fetch GET "/api/v1/plots/overlay.png?jobs=$id&theme=blue"
check "a theme that is none" "400 invalid_query" "$CODE $(field .code)"

# No room is left on the disk, by what has to stay free of it.
stop_daemon TERM
start_daemon --workers 1 --disk-reserve 1e7
fetch POST /api/v1/jobs --data-binary "$(job)"
check "no room for a job" "507 no_space" "$CODE $(field .code)"
check_match "when to try again" '^[1-9][0-9]*$' "$(header Retry-After)"
fetch GET "/api/v1/jobs/$id/result"
check "what is there can be read" 200 "$CODE"
finish
