#!/bin/bash
# Who may come in: tokens and roles, signing in with a browser, limits of rates, proxies.
. "$(dirname "$0")/lib.sh"
ROUTES=$(dirname "$0")/../../server/http/route.c

# token ARGUMENT...: the command on this test's data directory.
token() {
  "$BIN/pneulabd" token "$@" --data "$DATA" 2>> "$WORK/token.err"
}

# as TOKEN METHOD PATH [CURL OPTION...]: fetch with a token, or without one.
as() {
  local secret=$1
  shift
  fetch "$@" ${secret:+-H "Authorization: Bearer $secret"}
}

# until_code CODE TOKEN: waits at most a second for what a token gets.
until_code() {
  for _ in $(seq 20); do
    as "$2" GET /api/v1/caller
    [ "$CODE" = "$1" ] && break
    sleep 0.05
  done
  printf '%s' "$CODE"
}

# refused_start PATTERN OPTION...: the daemon does not start with these and says why.
refused_start() {
  local pattern=$1
  shift
  check_match "start with $*" "$pattern" \
    "$(timeout 10 "$BIN/pneulabd" --data "$WORK/none" "$@" 2>&1; echo "status $?")"
}
refused_start 'needs --tls-certificate.*status 1|needs --tls-certificate' --listen 0.0.0.0:0
refused_start 'needs --tls-certificate' --listen '[::]:0'
refused_start 'belong together' --listen 127.0.0.1:0 --tls-key "$WORK/none.key"
refused_start 'none.pem: .*--tls-key' --tls-certificate "$WORK/none.pem" --tls-key "$WORK/none.key"
check "nothing was made of it" "" "$(ls "$WORK/none" 2> /dev/null)"

# On a loopback address everybody is an administrator until there is a token.
start_daemon --solver "$(solver 'result succeeded')"
fetch GET /api/v1/caller
check "without tokens" '200 {"name":"","role":"admin"}' "$CODE $(field .)"
id=$(submit)
wait_state "$id" succeeded > /dev/null
reader=$(token add reader)
submitter=$(token add alice@lab --role submit)
admin=$(token add admin --role admin)
check "a token is needed within a second" 401 "$(until_code 401 '')"
check "and asked for" 'Bearer realm="pneulab" unauthorized' \
  "$(fetch GET /api/v1/jobs; header WWW-Authenticate) $(fetch GET /api/v1/jobs; field .code)"
check_match "secrets have 256 bits" '^pneulab_[0-9a-f]{64}$' "$reader"
check "the file is private" 600 "$(stat -c %a "$DATA/tokens.json")"
check "the database is private" 600 "$(stat -c %a "$DATA/pneulab.db")"
check "no secret is stored" 0 "$(grep -c "${reader#pneulab_}" "$DATA/tokens.json")"
check "but its hash" 1 "$(grep -c "$(printf %s "$reader" | sha256sum | cut -d' ' -f1)" "$DATA/tokens.json")"
check "the list" "reader read alice@lab submit admin admin" \
  "$(token list | awk '{ print $1, $2 }' | paste -sd' ')"
for name in reader '' 'a b' '../x' "$(printf 'x%.0s' {1..64})"; do
  check "token add '$name' is refused" 1 "$(token add "$name" > /dev/null; echo $?)"
done
check "a word that is no command" 2 "$(token list now > /dev/null; echo $?)"
check "a role that is none" 2 "$(token add x --role root > /dev/null; echo $?)"
check "a word that is none" 2 "$(token grant x > /dev/null; echo $?)"
check "no word" 2 "$(token > /dev/null; echo $?)"
check "its help" "0 usage:" "$(token --help > "$WORK/help"; echo "$? $(head -c 6 "$WORK/help")")"
check "a directory that is a file" 1 "$("$BIN/pneulabd" token list --data "$DATA/tokens.json" 2> /dev/null; echo $?)"
check "a path that is too long" 2 "$("$BIN/pneulabd" token list --data "$DATA/$(printf 'x/%.0s' {1..2040})" 2> /dev/null; echo $?)"

# Each route asks for the role that the table and the description say, and for no less.
declare -A secret=([NONE]='' [READ]=$reader [SUBMIT]=$submitter [ADMIN]=$admin)
declare -A below=([READ]=NONE [SUBMIT]=READ [ADMIN]=SUBMIT) answer=([READ]=401 [SUBMIT]=403 [ADMIN]=403)
curl -s "$URL/openapi.json" > "$WORK/openapi.json"
count=0
# shellcheck disable=SC2034 # method, role and pattern are read by name
while read -r method role pattern; do
  count=$((count + 1))
  described=$(jq -r --arg path "/$pattern" --arg method "${method,,}" '.security as $all |
    .paths[$path][$method] | if . then (.security // $all) | map(.bearer // []) | flatten |
    first // "none" else "none" end' "$WORK/openapi.json")
  check "role of $method /$pattern in the description" "${role,,}" "$described"
  path=/$(sed 's/{id}/4711/; s/{[a-z]*}/x/' <<< "$pattern")
  if [ "$role" != NONE ]; then
    as "${secret[${below[$role]}]}" "$method" "$path" -m 1
    check "$method $path with less than $role" "${answer[$role]}" "$CODE"
  fi
  as "${secret[$role]}" "$method" "$path" -m 1
  check_match "$method $path with $role" '^(200|303|304|4(00|04|09|22))$' "$CODE"
done < <(sed -n 's/^ *{HTTP_\([A-Z]*\), ROLE_\([A-Z]*\), "\([^"]*\)".*/\1 \2 \3/p' "$ROUTES")
check "all routes were tried" true "$([ "$count" -ge 30 ] && echo true)"
as "$reader" POST /api/v1/jobs --data-binary "$(job)"
check "what the role lacks" "403 forbidden" "$CODE $(field .code)"
as "$submitter" POST /api/v1/jobs --data-binary "$(job)"
check "a submission" 202 "$CODE"

# Changes need no restart; those who lost their token are out within a second.
renewed=$(token rotate reader)
check "the old secret is void" 401 "$(until_code 401 "$reader")"
check "the new one is good" 200 "$(until_code 200 "$renewed")"
token revoke alice@lab
check "revoked" 401 "$(until_code 401 "$submitter")"
check "revoking it again" 1 "$(token revoke alice@lab; echo $?)"
mv "$DATA/tokens.json" "$WORK/kept.json"
check "without the file nobody comes in" 401 "$(until_code 401 "$admin")"
echo '{"tokens":[{}]}' > "$DATA/tokens.json"
sleep 0.5
check "a damaged file lets nobody in" 401 "$(as "$admin" GET /api/v1/caller; echo "$CODE")"
mv "$WORK/kept.json" "$DATA/tokens.json"
check "the file is back" 200 "$(until_code 200 "$admin")"

# Wrong tokens: counted by address, logged without the token; right ones go on.
for header in 'Authorization: Bearer' "Authorization: Basic ${admin}" "Authorization: Bearer x$admin" \
  "Authorization: Bearer ${admin}0" "Authorization: Bearer ${admin^^}" "Cookie: pneulab=${admin%?}" \
  "X-Authorization: Bearer $admin"; do
  fetch GET /api/v1/jobs -H "$header"
  check_match "$header" '^(401|429)$' "$CODE"
done
fetch GET /api/v1/jobs -H "Authorization: Bearer $admin" -H "Authorization: Bearer $admin"
check "two tokens" "400 ambiguous_credentials" "$CODE $(field .code)"
curl -s -o /dev/null -H 'Authorization: Bearer secret-word' "$URL/api/v1/jobs#[1-12]"
as secret-word GET /api/v1/jobs
check "too many wrong tokens" "429 too_many_requests" "$CODE $(field .code)"
check_match "when to try again" '^[1-9][0-9]?$' "$(header Retry-After)"
as "$admin" GET /api/v1/jobs
check "the right one is not kept waiting" 200 "$CODE"
check_match "logged" 'a wrong token from 127.0.0.1' "$(cat "$WORK/stderr")"
check "without the secret" 0 "$(grep -cE "secret-word|pneulab_[0-9a-f]{8}" "$WORK/stderr")"

# A browser: the form, the cookie, and pages of other origins.
fetch GET /sign-in
check_match "the form" 'name="token"' "$BODY"
for path in / /jobs/1 /studies/1 /compare?jobs=1,2 /submit?from=1; do
  fetch GET "$path"
  check "$path has data: it leads to the form" "303 /sign-in?next=$path" "$CODE $(header Location)"
  fetch GET "$path" -H 'Sec-Fetch-Site: cross-site' -H 'Sec-Fetch-Mode: navigate'
  check "$path from a foreign page: once more from here" "200 1" \
    "$CODE $(grep -cF "content=\"0; url=$path\"" <<< "$BODY")"
  as "$admin" GET "$path"
  check_match "$path with a token" '^(200|404) text/html' "$CODE $(header Content-Type)"
done
fetch GET '/?kind=%22%3E%3Cscript%3E'
check "what would need escapes is left out" "303 /sign-in?next=/" "$CODE $(header Location)"
fetch GET '/?kind=%22%3E%3Cscript%3E' -H 'Sec-Fetch-Site: cross-site' -H 'Sec-Fetch-Mode: navigate'
check "there, too" 1 "$(grep -cF 'content="0; url=/"' <<< "$BODY")"
fetch POST '/sign-in?next=/jobs/1' --data-urlencode "token= $admin "
check "signed in" "303 /jobs/1" "$CODE $(header Location)"
cookie=$(header Set-Cookie)
check "the cookie" "pneulab=$admin; Path=/; HttpOnly; SameSite=Strict" "$cookie"
for next in //evil.example /%5cevil.example https://evil.example '/%0d%0aX:y' '/"' javascript:0; do
  fetch POST "/sign-in?next=$next" --data-urlencode "token=$admin"
  check_match "next=$next leads nowhere else" '^(303 /|400 )$' "$CODE $(header Location)"
done
fetch GET /api/v1/jobs -b "${cookie%%;*}"
check "the cookie is a token" 200 "$CODE"
fetch DELETE "/api/v1/jobs/4711" -b "${cookie%%;*}" -H 'Origin: http://evil.example'
check "cookie and foreign origin" "403 cross_origin" "$CODE $(field .code)"
fetch DELETE "/api/v1/jobs/4711" -b "${cookie%%;*}"
check "cookie without origin" "403 cross_origin" "$CODE $(field .code)"
fetch DELETE "/api/v1/jobs/4711" -b "${cookie%%;*}" -H "Origin: $URL"
check "cookie and our own origin" 404 "$CODE"
fetch GET /api/v1/jobs -H 'Sec-Fetch-Site: cross-site' -H 'Sec-Fetch-Mode: no-cors' -b "${cookie%%;*}"
check "loaded into a foreign page" "403 cross_origin" "$CODE $(field .code)"
fetch GET / -H 'Sec-Fetch-Site: cross-site' -H 'Sec-Fetch-Mode: navigate' -b "${cookie%%;*}"
check "a link from a foreign page" 200 "$CODE"
fetch POST /sign-in -H 'Origin: http://evil.example' --data-urlencode "token=$admin"
check "signing in from elsewhere" 403 "$CODE"
fetch POST /sign-out -b "${cookie%%;*}" -H "Origin: $URL"
check "signed out" "303 pneulab=; Path=/; HttpOnly; SameSite=Strict; Max-Age=0" "$CODE $(header Set-Cookie)"
fetch GET /api/v1/jobs
for name in Cross-Origin-Opener-Policy Cross-Origin-Resource-Policy; do
  check "$name" same-origin "$(header "$name")"
done
stop_daemon TERM

# Rates: ten seconds' worth at once, then the rest by and by.
start_daemon --request-rate 2
check "requests above the rate" "200 429" "$(curl -s -o /dev/null -w '%{http_code}\n' \
  -H "Authorization: Bearer $admin" "$URL/api/v1/caller#[1-40]" | sort -u | paste -sd' ')"
as "$admin" GET /api/v1/caller
check_match "refused with a time" '^429 1 too_many_requests$' "$CODE $(header Retry-After) $(field .code)"
as "$renewed" GET /api/v1/caller
check "another token has its own rate" 200 "$CODE"
check_match "without a token the address counts" '(127.0.0.1)' \
  "$(curl -s "$URL/healthz#[1-30]" | jq -r 'select(.status == 429).detail' | head -1)"
stop_daemon TERM

# Over IPv6, where the kernel has it. Without a certificate a SIGHUP changes nothing.
if grep -q '^0*1 ' /proc/net/if_inet6 2> /dev/null; then
  start_daemon --listen '[::1]:0'
  kill -HUP "$DAEMON_PID"
  as wrong GET /api/v1/caller
  check "a wrong token over IPv6" 401 "$CODE"
  check_match "its address" 'wrong token from ::1$' "$(grep wrong "$WORK/stderr" | tail -1)"
  as "$admin" GET /api/v1/caller
  check "a good one" 200 "$CODE"
  stop_daemon TERM
fi

# Behind a proxy: its word for the address is believed, the client's is not; names are given.
start_daemon --behind-proxy --host lab.example,other.example --host third.example --connections-per-address 2
for host in lab.example LAB.example:443 third.example 127.0.0.1; do
  as "$admin" GET /api/v1/caller -H "Host: $host"
  check "Host: $host" 200 "$CODE"
done
for host in evil.example lab.example.evil xlab.example lab.example:x 'lab.example@evil' 10.0.0.1; do
  as "$admin" GET /api/v1/caller -H "Host: $host"
  check "Host: $host" 421 "$CODE"
done
as wrong GET /api/v1/caller -H 'X-Forwarded-For: 192.0.2.1, 203.0.113.9'
check_match "the address that the proxy saw" 'wrong token from 203.0.113.9$' "$(tail -1 "$WORK/stderr")"
as wrong GET /api/v1/caller -H 'X-Forwarded-For: nonsense'
check_match "an address that is none" 'wrong token from 127.0.0.1$' "$(tail -1 "$WORK/stderr")"
as wrong GET /api/v1/caller -H 'X-Forwarded-For: 2001:db8::7'
check_match "one of IPv6" 'wrong token from 2001:db8::7$' "$(tail -1 "$WORK/stderr")"
as wrong GET /api/v1/caller -H "X-Forwarded-For: $(printf '1%.0s' {1..200})"
check_match "a long one" 'wrong token from 127.0.0.1$' "$(tail -1 "$WORK/stderr")"
as wrong GET /api/v1/caller -H 'X-Forwarded-For;'
check_match "an empty one" 'wrong token from 127.0.0.1$' "$(tail -1 "$WORK/stderr")"
fetch POST /sign-in -H 'X-Forwarded-Proto: https' -H 'Host: lab.example' -H 'Origin: https://lab.example' \
  --data-urlencode "token=$admin"
check_match "the cookie of a proxy that speaks TLS" '^__Host-pneulab=.*; Secure' "$(header Set-Cookie)"
fetch POST /sign-in -H 'X-Forwarded-Proto: https' -H 'Host: lab.example' -H 'Origin: http://lab.example' \
  --data-urlencode "token=$admin"
check "a page without TLS is another origin" 403 "$CODE"
fetch POST '/sign-in?next=/jobs%3Fstate=held%26sort=name' -H 'X-Forwarded-For: 192.0.2.50' --data-raw 'x=1&token=wrong'
check "a wrong token leads back to the form" '303 /sign-in?next=/jobs?state=held%26sort=name#failed' \
  "$CODE $(header Location)"
for form in '' token 'token=' 'x=y' 'token=%zz' 'token=%00' '&&=&token'; do
  fetch POST /sign-in -H 'X-Forwarded-For: 192.0.2.50' --data-raw "$form"
  check_match "the form '$form'" '^303 /sign-in.next=/#failed$' "$CODE $(header Location)"
done
for _ in 1 2; do
  fetch POST /sign-in -H 'X-Forwarded-For: 192.0.2.50' --data-raw 'token=wrong'
done
fetch POST /sign-in -H 'X-Forwarded-For: 192.0.2.50' --data-raw 'token=wrong'
check "too many wrong tokens in forms" "429 too_many_requests" "$CODE $(field .code)"
fetch POST /sign-in --data-raw "a&=&token=$admin&token=wrong"
check "the first field of that name counts" "303 /" "$CODE $(header Location)"
pids=()
for _ in 1 2; do
  curl -s -N -m 3 -o /dev/null -H "Authorization: Bearer $admin" -H 'X-Forwarded-For: 192.0.2.7' \
    "$URL/api/v1/events" &
  pids+=($!)
done
sleep 0.5
as "$admin" GET /api/v1/caller -H 'X-Forwarded-For: 192.0.2.7'
check "requests at a time of one address" 429 "$CODE"
as "$admin" GET /api/v1/caller -H 'X-Forwarded-For: 192.0.2.8'
check "of another" 200 "$CODE"
kill "${pids[@]}" 2> /dev/null
finish
