#!/bin/bash
# The example configuration of nginx in front of a daemon: TLS, who the client is, events as they
# come, limits.
. "$(dirname "$0")/lib.sh"
command -v nginx > /dev/null && command -v openssl > /dev/null || { echo "SKIP: no nginx"; exit 77; }
EXAMPLE=$(dirname "$0")/../../contrib/nginx/pneulab.conf
SOLVER=$(solver 'progress 0.5 25; sleep 0.3; result succeeded')
mkdir "$WORK/nginx"
openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 1 \
  -subj /CN=pneulab.example.org -addext subjectAltName=DNS:pneulab.example.org \
  -keyout "$WORK/nginx/key" -out "$WORK/nginx/certificate" 2> /dev/null
TOKEN=$("$BIN/pneulabd" token add tester --role admin --data "$DATA" | grep -Eo '[^ ]{20,}' | head -1)
start_daemon --workers 2 --solver "$SOLVER" --behind-proxy --host pneulab.example.org \
  --log-level request
INSIDE=$URL
# A port that is free now; nginx cannot tell which one it took.
front=$(python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
sed -e "s|127.0.0.1:8080|127.0.0.1:$PORT|" -e "s|listen 443|listen 127.0.0.1:$front|" \
  -e "s|/etc/ssl/certs/pneulab.pem|$WORK/nginx/certificate|" \
  -e "s|/etc/ssl/private/pneulab.key|$WORK/nginx/key|" "$EXAMPLE" > "$WORK/nginx/site"
cat > "$WORK/nginx/conf" <<END
daemon off; worker_processes 1; pid $WORK/nginx/pid; error_log $WORK/nginx/error warn;
events { worker_connections 64; }
http {
  access_log off; client_body_temp_path $WORK/nginx/b; proxy_temp_path $WORK/nginx/p;
  fastcgi_temp_path $WORK/nginx/f; uwsgi_temp_path $WORK/nginx/u; scgi_temp_path $WORK/nginx/s;
  include $WORK/nginx/site;
}
END
chmod 755 "$WORK" # its workers are another user
nginx -c "$WORK/nginx/conf" -e "$WORK/nginx/error" 2> "$WORK/nginx/start" &
nginx=$!
outside() {
  curl -s --cacert "$WORK/nginx/certificate" -H "Authorization: Bearer $TOKEN" \
    --resolve "pneulab.example.org:$front:127.0.0.1" -m 20 "$@"
}
URL=https://pneulab.example.org:$front
for _ in $(seq 50); do outside -o /dev/null "$URL/healthz" && break; sleep 0.1; done

check "alive through TLS" ok "$(outside "$URL/healthz" | jq -r .status)"
outside -N "$URL/api/v1/events" > "$WORK/events" &
follower=$!
sleep 0.3
answer=$(outside -i -H 'Prefer: wait=20' -H 'X-Forwarded-For: 10.9.8.7' --data-binary "$(job)" "$URL/api/v1/jobs")
check_match "a job" '"state": ?"succeeded"' "$answer"
check_match "with the id that nginx gave" '^[0-9a-f]{32}$' \
  "$(sed -n 's/^x-request-id: //Ip' <<< "$answer" | tr -d '\r')"
sleep 0.5
check "events came while the stream is open" "1 yes" \
  "$(grep -c '"state":"succeeded"' "$WORK/events") $(alive $follower)"
kill $follower
check "a body over the limit" 413 \
  "$(head -c 1100000 /dev/zero | outside -o /dev/null -w '%{http_code}' --data-binary @- "$URL/api/v1/jobs")"
check "metrics for this machine" 200 "$(outside -o /dev/null -w '%{http_code}' "$URL/metrics")"
check "another name" 421 "$(curl -s -o /dev/null -w '%{http_code}' -H 'Host: evil.example.org' "$INSIDE/api/v1/jobs")"
kill -QUIT $nginx
wait $nginx
check "nginx had nothing to say" "" "$(grep -hv 'client intended to send too large body' "$WORK/nginx/error" "$WORK/nginx/start")"
check "the log knows the caller" tester "$(sed -n 's/.*path=.api.v1.jobs status=200.* caller=\([^ ]*\).*/\1/p' "$WORK/stderr" | head -1)"
URL=$INSIDE
finish
