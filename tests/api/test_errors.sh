#!/bin/bash
# Every kind of bad input: a problem document that says where, and a daemon that goes on.
. "$(dirname "$0")/lib.sh"
start_daemon --solver "$(solver 'result succeeded')"

# refused WHAT CODE WORD POINTER DOCUMENT
refused() {
  fetch POST /api/v1/jobs --data-binary "$5"
  check "$1: status, code, pointer" "$2 $3 $4" "$CODE $(field '.code + " " + .pointer')"
  check "$1: type" application/problem+json "$(header Content-Type)"
  check "$1: status in the body" "$2" "$(field .status)"
  check "$1: all members" true "$(field 'has("type") and has("title") and has("detail")')"
  check_match "$1: line" '^[1-9][0-9]*$' "$(field .line)"
  check_match "$1: column" '^[1-9][0-9]*$' "$(field .column)"
}
refused "wrong unit" 422 invalid_job /actuator/top_wall "$(job '.actuator.top_wall = "2 kPa"')"
refused "missing unit" 422 invalid_job /actuator/top_wall "$(job '.actuator.top_wall = "2"')"
refused "number for a quantity" 422 invalid_job /actuator/top_wall "$(job '.actuator.top_wall = 2')"
refused "unknown key" 422 invalid_job /actuator/top_wal "$(job '.actuator.top_wal = "2 mm"')"
refused "negative wall" 422 invalid_job /actuator/side_wall "$(job '.actuator.side_wall = "-1 mm"')"
refused "wrong type" 422 invalid_job /contact "$(job '.contact = "yes"')"
refused "unknown kind" 422 invalid_job /kind "$(job '.kind = "dance"')"
refused "unknown material" 422 invalid_job /material "$(job '.material = "cheese"')"
refused "array for a job" 422 invalid_job "" '[]'
refused "duplicate key" 400 syntax_error "" '{"kind":"response","kind":"response"}'
refused "truncated JSON" 400 syntax_error "" '{"kind":"resp'
refused "empty body" 400 syntax_error "" ''
refused "not JSON" 400 syntax_error "" 'hello'
refused "deep nesting" 400 syntax_error "" "$(printf '[%.0s' $(seq 100))"
fetch POST /api/v1/jobs --data-binary "$(printf '{\n  "kind": "response",\n  oops\n}')"
check "the line of a syntax error" 3 "$(field .line)"
check_match "an unknown key names the nearest" top_wall \
  "$(curl -s --data-binary "$(job '.actuator.top_wal = "2 mm"')" "$URL/api/v1/jobs" | jq -r .detail)"
fetch POST /api/v1/jobs:validate --data-binary "$(job '.accuracy = "fats"')"
check "the parts of the sentence" '"fats"/"draft", "fast", "standard" or "fine"/fast/fast' \
  "$(field '[.found, .allowed, .nearest, .example] | join("/")')"
check_match "its place" "^/accuracy .line [0-9]+, column [0-9]+.: " "$(field .detail)"
job '.accuracy = "fats"' > "$WORK/wrong.json"
check "the same words on the command line" "pneulab-solve: $(field .detail)" \
  "$(./pneulab-solve "$WORK/wrong.json" 2>&1 > "$WORK/refusal")"
check "and in its document" "$(field '[.pointer, .line, .column, .found, .allowed, .example]')" \
  "$(jq -c '.error | [.pointer, .line, .column, .found, .allowed, .example]' "$WORK/refusal")"
fetch POST /api/v1/jobs --data-binary "$(job '.actuator.height = "3 mm"')"
check_match "what a body allows" 'at least' "$(field .allowed)"
check "nothing was stored" 0 "$(sql 'select count(*) from job')"

head -c 2097152 /dev/zero | tr '\0' ' ' > "$WORK/big"
fetch POST /api/v1/jobs --data-binary "@$WORK/big"
check "2 MiB with Expect" "413 too_large" "$CODE $(field .code)"
fetch POST /api/v1/jobs -H 'Expect:' --data-binary "@$WORK/big"
check "2 MiB without Expect" "413 too_large" "$CODE $(field .code)"
fetch POST /api/v1/jobs -H 'Expect:' -H 'Transfer-Encoding: chunked' --data-binary "@$WORK/big"
check "2 MiB in chunks" "413 too_large" "$CODE $(field .code)"
truncate -s 1048576 "$WORK/big"
fetch POST /api/v1/jobs --data-binary "@$WORK/big"
check "exactly 1 MiB is read" "400 syntax_error" "$CODE $(field .code)"

# not_allowed METHOD PATH ALLOW
not_allowed() {
  fetch "$1" "$2"
  check "$1 $2" "405 method_not_allowed $3" "$CODE $(field .code) $(header Allow)"
}
not_allowed PUT /api/v1/jobs "GET, HEAD, POST"
not_allowed PUT /api/v1/jobs/1 "GET, HEAD, PATCH, DELETE"
not_allowed GET /api/v1/jobs/1/cancel POST
not_allowed DELETE /healthz "GET, HEAD"
not_allowed POST / "GET, HEAD"
not_allowed OPTIONS /metrics "GET, HEAD"

for path in /nothing /api /api/v1 /api/v1/jobs/ /api/v1/jobs//result /api/v1/jobs/1 /api/v1/jobs/abc \
  /api/v1/jobs/-1 /api/v1/jobs/0 /api/v1/jobs/01 /api/v1/jobs/1e3 /api/v1/jobs/99999999999999999999 \
  /api/v1/jobs/1/result /api/v1/jobs/1/samples.csv /api/v1/jobs/1/log /api/v1/jobs/1/attempts \
  /api/v1/jobs/1/artifacts/x /api/v1/jobs/1/plots/angle.png /api/v1/schemas/nothing \
  /api/v1/jobs/1/document /api/v1/jobs/1/plots/.png /a/b/c/d/e/f/g/h; do
  fetch GET $path
  check "GET $path" "404 application/problem+json" "$CODE $(header Content-Type)"
done
fetch DELETE /api/v1/jobs/1
check "DELETE of an unknown job" "404 not_found" "$CODE $(field .code)"
fetch POST /api/v1/jobs/1/cancel
check "cancel of an unknown job" "404 not_found" "$CODE $(field .code)"

for path in /%2e%2e/etc/passwd /../etc/passwd /api/v1/jobs/1/artifacts/..%2f..%2fpneulab.db \
  /static/%2e%2e/x /a%00b /a%0ab '/%' '/%zz' /%ff '/a\b' '/a/b/c/d/e/f/g/h/i' \
  '/api/v1/jobs?a=%00' '/api/v1/jobs?limit=1&limit=2'; do
  fetch GET "$path"
  check "GET $path" "400 application/problem+json" "$CODE $(header Content-Type)"
done
fetch GET /
check "pages are still served" 200 "$CODE"
finish
