#!/bin/bash
# HTTPS: versions, cookies, a certificate that is replaced while the daemon runs.
. "$(dirname "$0")/lib.sh"
command -v openssl > /dev/null || { echo "SKIP: openssl is not installed"; exit 77; }
for name in first second; do
  openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 2 -subj "/CN=$name" \
    -addext 'subjectAltName=DNS:localhost,DNS:lab.example,IP:127.0.0.1' \
    -keyout "$WORK/$name.key" -out "$WORK/$name.pem" 2> /dev/null
done
cp "$WORK/first.pem" "$WORK/chain.pem"
cp "$WORK/first.key" "$WORK/key.pem"
check_match "a key of another certificate" 'do not match' \
  "$("$BIN/pneulabd" --data "$WORK/none" --listen 127.0.0.1:0 --tls-certificate "$WORK/first.pem" \
    --tls-key "$WORK/second.key" 2>&1)"

# All addresses of the machine; tokens are needed even where there is none yet.
start_daemon --listen 0.0.0.0:0 --tls-certificate "$WORK/chain.pem" --tls-key "$WORK/key.pem" \
  --header-timeout 1 --solver "$(solver 'result succeeded')"
export CURL_CA_BUNDLE=$WORK/first.pem
check_match "where it listens" '^https://0.0.0.0:[0-9]+$' "$URL"
URL=https://127.0.0.1:$PORT
fetch GET /healthz
check "HTTPS" 200 "$CODE"
fetch GET /api/v1/jobs
check "nobody is let in" 401 "$CODE"
secret=$("$BIN/pneulabd" token add admin --role admin --data "$DATA")
sleep 0.5
fetch GET /api/v1/caller -H "Authorization: Bearer $secret"
check "the first token" '200 {"name":"admin","role":"admin"}' "$CODE $(field .)"
fetch POST /sign-in -H "Origin: $URL" --data-urlencode "token=$secret"
check_match "the cookie is for TLS and this host alone" \
  '^__Host-pneulab=pneulab_[0-9a-f]{64}; Path=/; HttpOnly; SameSite=Strict; Secure$' "$(header Set-Cookie)"
fetch POST /sign-in -H "Origin: http://127.0.0.1:$PORT" --data-urlencode "token=$secret"
check "a page without TLS is another origin" 403 "$CODE"
fetch GET /api/v1/caller -b "pneulab=$secret"
check "a cookie that a page without TLS could set" 401 "$CODE"
id=$(submit "$(job)" -H "Authorization: Bearer $secret")
fetch GET "/api/v1/jobs/$id?" -H "Authorization: Bearer $secret" -H 'Prefer: wait=20'
check "a job" succeeded "$(field .state)"
check "plain HTTP gets no answer" 000 \
  "$(curl -s -m 3 -o /dev/null -w '%{http_code}' "http://127.0.0.1:$PORT/healthz")"
for version in tls1_2 tls1_3; do
  check "$version" 1 "$(openssl s_client -connect "127.0.0.1:$PORT" -$version < /dev/null 2> /dev/null |
    grep -c 'BEGIN CERTIFICATE')"
done
check "TLS 1.1 is refused" 0 "$(openssl s_client -connect "127.0.0.1:$PORT" -tls1_1 \
  -cipher 'ALL:@SECLEVEL=0' < /dev/null 2> /dev/null | grep -c 'BEGIN CERTIFICATE')"
start=$SECONDS
sleep 4 | timeout 10 openssl s_client -quiet -connect "127.0.0.1:$PORT" > /dev/null 2>&1
check "one that says nothing is let go" true "$([ $((SECONDS - start)) -le 5 ] && echo true)"

# Replaced while a client is connected; a pair that does not fit changes nothing.
shown() {
  openssl s_client -connect "127.0.0.1:$PORT" < /dev/null 2> /dev/null | sed -n 's/^subject=CN = //p'
}
# reload WANTED: asks for the files to be read and waits for the log's answer.
reload() {
  kill -HUP "$DAEMON_PID"
  for _ in $(seq 40); do
    [ "$(grep -c 'the certificate' "$WORK/stderr")" -ge "$1" ] && break
    sleep 0.05
  done
}
check "the first certificate" first "$(shown)"
cp "$WORK/second.pem" "$WORK/chain.pem"
reload 1
check "a chain without its key is not taken" first "$(shown)"
cp "$WORK/second.key" "$WORK/key.pem"
reload 2
check "the second certificate" second "$(shown)"
export CURL_CA_BUNDLE=$WORK/second.pem
finish
