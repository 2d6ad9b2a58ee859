#!/bin/bash
# Requests that two parsers may read differently, cross-site requests, slow and many clients.
. "$(dirname "$0")/lib.sh"
RAW=${RAW:-$BIN/tests/api/raw_client}
start_daemon --header-timeout 2 --body-timeout 2 --solver "$(solver 'result succeeded')"

# raw WHAT STATUS END REQUEST [DELAY [SILENCE]]: sends the bytes (printf escapes); END is closed or open.
raw() {
  local answer
  answer=$(printf "$4" | "$RAW" "$PORT" "${5:-0}" "${6:-1000}" | tr -d '\r\0')
  check "$1" "$2 [$3]" "$(sed -n '1s/^HTTP[^ ]* \([0-9]*\).*/\1/p' <<< "$answer") $(tail -1 <<< "$answer")"
}
H='Host: localhost\r\n'
raw "a plain request" 200 open "GET /healthz HTTP/1.1\r\n$H\r\n"
raw "length and coding" 400 closed "POST /api/v1/jobs HTTP/1.1\r\n${H}Content-Length: 3\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n"
raw "coding and length" 400 closed "POST /api/v1/jobs HTTP/1.1\r\n${H}Transfer-Encoding: chunked\r\nContent-Length: 3\r\n\r\n0\r\n\r\n"
raw "two lengths" 400 closed "POST /api/v1/jobs HTTP/1.1\r\n${H}Content-Length: 2\r\nContent-Length: 20\r\n\r\n{}"
raw "two equal lengths" 400 closed "POST /api/v1/jobs HTTP/1.1\r\n${H}Content-Length: 2\r\nContent-Length: 2\r\n\r\n{}"
raw "a list of lengths" 400 closed "POST /api/v1/jobs HTTP/1.1\r\n${H}Content-Length: 2, 2\r\n\r\n{}"
raw "a signed length" 400 closed "POST /api/v1/jobs HTTP/1.1\r\n${H}Content-Length: +2\r\n\r\n{}"
raw "a negative length" 400 closed "POST /api/v1/jobs HTTP/1.1\r\n${H}Content-Length: -1\r\n\r\n"
raw "two hosts" 400 closed "GET /healthz HTTP/1.1\r\n$H$H\r\n"
raw "no host" 400 closed "GET /healthz HTTP/1.1\r\n\r\n"
raw "space before the colon" 400 closed "GET /healthz HTTP/1.1\r\n${H}Content-Length : 5\r\n\r\n"
raw "unknown coding" 501 closed "POST /api/v1/jobs HTTP/1.1\r\n${H}Transfer-Encoding: gzip\r\n\r\n"
raw "coded twice" 501 closed "POST /api/v1/jobs HTTP/1.1\r\n${H}Transfer-Encoding: gzip, chunked\r\n\r\n0\r\n\r\n"
raw "two codings" 400 closed "POST /api/v1/jobs HTTP/1.1\r\n${H}Transfer-Encoding: chunked\r\nTransfer-Encoding: identity\r\n\r\n0\r\n\r\n"
raw "a chunk size that is none" 400 closed "POST /api/v1/jobs HTTP/1.1\r\n${H}Transfer-Encoding: chunked\r\n\r\nzz\r\n\r\n"
raw "a chunk size beyond all bounds" 413 closed "POST /api/v1/jobs HTTP/1.1\r\n${H}Transfer-Encoding: chunked\r\n\r\nFFFFFFFFFFFFFFFFFF\r\n\r\n"
raw "target on another host" 421 closed "GET http://example.org/healthz HTTP/1.1\r\n$H\r\n"
raw "absolute target" 200 open "GET http://localhost/healthz HTTP/1.1\r\n$H\r\n"
raw "target without a slash" 400 closed "GET healthz HTTP/1.1\r\n$H\r\n"
raw "fragment" 400 closed "GET /healthz#x HTTP/1.1\r\n$H\r\n"
raw "NUL in the target" 400 closed "GET /healthz\0x HTTP/1.1\r\n$H\r\n"
raw "encoded NUL" 400 closed "GET /healthz%%00 HTTP/1.1\r\n$H\r\n"
raw "encoded way up" 400 closed "GET /%%2e%%2e/%%2e%%2e/etc/passwd HTTP/1.1\r\n$H\r\n"
raw "HTTP/1.0 without a host" 200 closed "GET /healthz HTTP/1.0\r\n\r\n"
raw "HTTP/1.0 with the host in the target" 200 closed "GET http://localhost/healthz HTTP/1.0\r\n\r\n"
raw "folded header" 400 closed "GET /healthz HTTP/1.1\r\n$H folded: x\r\n\r\n"
raw "unknown version" 505 closed "GET /healthz HTTP/2.0\r\n$H\r\n"
raw "asterisk" 400 closed "OPTIONS * HTTP/1.1\r\n$H\r\n"
raw "no HTTP at all" "" closed "\x16\x03\x01\x02\r\n\r\n"
answer=$(printf "POST /api/v1/jobs HTTP/1.1\r\n${H}Content-Length: 4\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\nGET /metrics HTTP/1.1\r\n$H\r\n" | "$RAW" "$PORT")
check "nothing smuggled is answered" 1 "$(grep -c '^HTTP/1.1' <<< "$answer")"
answer=$(printf "GET /healthz HTTP/1.1\r\n$H\r\nGET /readyz HTTP/1.1\r\n$H\r\n" | "$RAW" "$PORT")
check "pipelined requests are answered in turn" "ok ready" "$(sed -n 's/.*"status": "\(.*\)".*/\1/p' <<< "$answer" | paste -sd' ')"

# Lines that others may read differently: each of these hid a header from libmicrohttpd, or gave it one.
P="POST /api/v1/jobs:validate HTTP/1.1\r\n$H"
raw "a bare LF" 400 closed "GET /healthz HTTP/1.1\r\nX: y\n$H\r\n"
raw "a bare LF after the request line" 400 closed "GET /healthz HTTP/1.1\n$H\r\n"
raw "a length after a bare LF" 400 closed "GET /healthz HTTP/1.1\r\n${H}X: y\nContent-Length: 30\r\n\r\n"
raw "a bare CR" 400 closed "GET /healthz HTTP/1.1\r\n${H}X: a\rContent-Length: 5\r\n\r\n"
raw "NUL in a value" 400 closed "GET /healthz HTTP/1.1\r\n${H}X: a\0b\r\n\r\n"
raw "NUL in a value, not the last" 400 closed "GET /healthz HTTP/1.1\r\nX: a\0b\r\n$H\r\n"
raw "NUL in a name" 400 closed "GET /healthz HTTP/1.1\r\n${H}X\0Y: b\r\n\r\n"
raw "a folded coding" 400 closed "${P}Transfer-Encoding:\r\n chunked\r\nContent-Length: 3\r\n\r\n0\r\n\r\n"
raw "a folded length" 400 closed "${P}Content-Length:\r\n\t2\r\n\r\n{}"
raw "a first line that is folded" 400 closed "GET /healthz HTTP/1.1\r\n X: y\r\n$H\r\n"
raw "a line without a colon" 400 closed "GET /healthz HTTP/1.1\r\n${H}nonsense\r\n\r\n"
for line in ': x' : ':\t' ':: x' ': Content-Length: 5'; do
  answer=$(printf "GET /healthz HTTP/1.1\r\n${H}$line\r\nGET /readyz HTTP/1.1\r\n$H\r\n" | "$RAW" "$PORT" | tr -d '\r\0')
  check "the line '$line' does not end a header" "HTTP/1.1 400 Bad Request" "$(grep '^HTTP' <<< "$answer")"
done
raw "a line without a name, not the last" 400 closed "GET /healthz HTTP/1.1\r\n: x\r\n$H\r\n"
raw "a bare LF after the header" 400 closed "GET /healthz HTTP/1.1\r\n$H\n"
raw "DEL in a value" 400 closed "GET /healthz HTTP/1.1\r\n${H}X: a\x7fb\r\n\r\n"
raw "blanks before a value" 200 open "GET /healthz HTTP/1.1\r\nX: \t y\r\n$H\r\n"
raw "coding identity and a length" 400 closed "${P}Transfer-Encoding: identity\r\nContent-Length: 2\r\n\r\n{}"
for coding in identity 'chunked, chunked' xchunked '"chunked"' 'chunked;q=1' 'chunked\t' ''; do
  raw "coding '$coding'" 501 closed "${P}Transfer-Encoding: $coding\r\n\r\n0\r\n\r\n"
done
raw "coding after VT" 400 closed "${P}Transfer-Encoding: \x0bchunked\r\n\r\n0\r\n\r\n"
for length in 18446744073709551618 9223372036854775807 99999999999999999999999; do
  raw "length $length" 413 closed "${P}Content-Length: $length\r\n\r\n{}"
done
for length in 0x2 '' '2 2' 2.0 2e0 '2;' -0 ' -2'; do
  raw "length '$length'" 400 closed "${P}Content-Length: $length\r\n\r\n{}"
done
C="${P}Transfer-Encoding: chunked\r\n\r\n"
for size in +2 -2 0x2 ' 2' '2 ' '' 2.0; do
  raw "chunk of '$size'" 400 closed "${C}$size\r\n{}\r\n0\r\n\r\n"
done
raw "a chunk that is longer than its size" 400 closed "${C}2\r\n{}XX0\r\n\r\n"
for end in ';x=y\r\n' ';x\n' ';x\ry\r\n' ';\0\r\n' '\n'; do
  raw "a connection ends with its chunks ($end)" 422 closed \
    "${C}2$end{}\r\n0\r\n\r\nGET /metrics HTTP/1.1\r\n$H\r\n"
done
raw "trailers are not headers" 422 closed "${C}2\r\n{}\r\n0\r\nContent-Length: 7\r\nHost: evil\r\n\r\n"
raw "an extension without end" 500 closed "${C}2;$(printf 'a%.0s' {1..50000})\r\n{}\r\n0\r\n\r\n"
raw "a long target" 414 closed "GET /$(printf 'a%.0s' {1..40000}) HTTP/1.1\r\n$H\r\n"
raw "a long header" 431 closed "GET /healthz HTTP/1.1\r\n${H}X: $(printf 'a%.0s' {1..40000})\r\n\r\n"
raw "many headers" 431 closed "GET /healthz HTTP/1.1\r\n$H$(printf 'X%d: y\\r\\n' {1..2000})\r\n"
for host in localhost@evil evil@localhost 'localhost, evil' localhost/x 'localhost\t' 'local host'; do
  raw "Host: $host" 421 closed "GET /healthz HTTP/1.1\r\nHost: $host\r\n\r\n"
done
raw "a user in the target" 421 closed "GET http://x@localhost/healthz HTTP/1.1\r\n$H\r\n"
for target in https://localhost/healthz ftp://localhost/healthz localhost:80 http:///healthz '\x80'; do
  raw "target $target" 400 closed "GET $target HTTP/1.1\r\n$H\r\n"
done
raw "no version" 400 closed "GET /healthz\r\n\r\n"
raw "HTTP/2 from the start" 505 closed "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"
raw "TRACE" 405 closed "TRACE /healthz HTTP/1.1\r\n$H\r\n"
answer=$(printf "GET /healthz HTTP/1.1\r\n$H$H\r\nGET /metrics HTTP/1.1\r\n$H\r\n" | "$RAW" "$PORT")
check "nothing is answered after a refusal" 1 "$(grep -c '^HTTP/1.1' <<< "$answer")"

# Names that are not ours, pages that are not ours.
for host in evil.example localhost.evil.example 10.0.0.1 '[::2]' 'localhost:80:80' 'localhost@evil' ''; do
  fetch GET /healthz -H "Host: $host"
  check_match "Host: $host" '^(421|400)$' "$CODE"
done
for host in localhost LOCALHOST:1 127.0.0.1 127.8.8.8:80 '[::1]' '[::1]:8080'; do
  fetch GET /healthz -H "Host: $host"
  check "Host: $host" 200 "$CODE"
done
fetch POST /api/v1/jobs:validate -H 'Origin: http://evil.example' --data-binary "$(job)"
check "foreign origin" "403 cross_origin" "$CODE $(field .code)"
fetch POST /api/v1/jobs:validate -H 'Origin: null' --data-binary "$(job)"
check "null origin" 403 "$CODE"
fetch POST /api/v1/jobs:validate -H "Origin: http://127.0.0.1:1" --data-binary "$(job)"
check "another port" 403 "$CODE"
fetch POST /api/v1/jobs:validate -H 'Sec-Fetch-Site: cross-site' --data-binary "$(job)"
check "cross-site without origin" 403 "$CODE"
fetch DELETE /api/v1/jobs/1 -H 'Origin: http://evil.example'
check "foreign DELETE" 403 "$CODE"
fetch POST /api/v1/jobs:validate -H "Origin: $URL" -H 'Sec-Fetch-Site: same-origin' --data-binary "$(job)"
check "our own page" 200 "$CODE"
fetch DELETE /api/v1/jobs/1 -H 'Sec-Fetch-Site: same-origin' -b a=b
check "our own page without its origin" 404 "$CODE"
fetch GET /healthz -H 'Sec-Fetch-Site: none'
check "typed by hand" 200 "$CODE"

# Numbers and lists in queries and headers.
for query in jobs= jobs=0x1 jobs=1,1,2 jobs=1,,2 jobs=1, jobs=,1 jobs=01 'jobs=1;2' jobs=99999999999999999999 \
  "jobs=$(seq -s, 51)"; do
  fetch GET "/api/v1/compare?$query"
  check "compare?${query:0:30}" "400 invalid_query" "$CODE $(field .code)"
done
for method_path in 'PATCH /api/v1/jobs/x' 'POST /api/v1/jobs/0x1/retry' 'GET /api/v1/jobs/01' 'DELETE /api/v1/jobs/-1' \
  'POST /api/v1/jobs/1a/cancel' 'GET /api/v1/jobs/99999999999999999999'; do
  fetch "${method_path% *}" "${method_path#* }"
  check "$method_path" "404 not_found" "$CODE $(field .code)"
done
key=(-H 'Idempotency-Key: once' --data-binary "$(job)")
fetch POST /api/v1/jobs -H 'Prefer: wait=20' "${key[@]}"
for wait in wait=20 'respond-async, wait=20' 'wait=20; x' WAIT=20; do
  fetch POST /api/v1/jobs -H "Prefer: $wait" "${key[@]}"
  check "Prefer: $wait" "succeeded wait=20" "$(field .state) $(header Preference-Applied)"
done
for wait in xwait=20 wait= wait=x wait=20x wait=-1 wait 'w ait=20'; do
  fetch POST /api/v1/jobs -H "Prefer: $wait" "${key[@]}"
  check "Prefer: $wait is passed over" "succeeded " "$(field .state) $(header Preference-Applied)"
done

# A header, and then a body, that trickle in.
start=$SECONDS
raw "slow header" 408 closed "GET /healthz HTTP/1.1\r\n${H}X-Slow: aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa\r\n\r\n" 200
check "ended in time" true "$([ $((SECONDS - start)) -le 5 ] && echo true)"
raw "slow body" 408 closed "POST /api/v1/jobs HTTP/1.1\r\n${H}Content-Length: 500\r\n\r\n{" 0 4000
fetch GET /healthz
check "others are served meanwhile" 200 "$CODE"

# One address holds 20 connections; more are turned away, and the rest goes on.
pids=()
for _ in $(seq 30); do
  sleep 1.5 | "$RAW" "$PORT" > "$WORK/idle.$_" 2>&1 &
  pids+=($!)
done
sleep 0.7
check "a connection over the limit is refused" 000 "$(curl -s -o /dev/null -m 2 -w '%{http_code}' "$URL/healthz")"
wait "${pids[@]}"
fetch GET /healthz
check "afterwards there is room again" 200 "$CODE"

finish
