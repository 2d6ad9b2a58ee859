#!/bin/bash
# Documents and workers that mean harm: names with markup, files that a browser would run, links
# out of the folder, pipes, answers that forge lines.
. "$(dirname "$0")/lib.sh"
# shellcheck disable=SC2016 # it is for the stand-in
BODY_OF_SOLVER='
cd "$out"
echo "<script>alert(1)</script>" > page.html
echo "<svg xmlns=\"http://www.w3.org/2000/svg\"><script>alert(1)</script></svg>" > drawing.svg
echo "<x:script xmlns:x=\"http://www.w3.org/1999/xhtml\">alert(1)</x:script>" > field.vtu
echo "%PDF" > report.pdf
ln -s ../../../pneulab.db linked.csv
ln -s /etc/passwd passwd.csv
: > ./-rf
mkfifo pipe.json
mkdir folder.json
truncate -s 20M large.inp
echo secret > ../outside.csv
case $(jq -r .name "$job") in
  moved) rm -rf ../out; mkdir ../elsewhere; echo moved > ../elsewhere/page.html; ln -s elsewhere ../out ;;
  pipe) mkfifo surface.json ;;
esac
printf "\033[2J\033]0;title\007a line\n2026-01-01T00:00:00.000Z forged\n" >&2
cat <<DOC
{"status":"succeeded","reason":"","message":"x\u001b[2J\n2026-01-01T00:00:00.000Z forged","kind":"response",
 "name":"n","metrics":{"bending_angle_deg":1},
 "samples":[{"pressure_kPa":0,"=cmd|/c calc":"+1","note":"@SUM(A1)"}],"midlines":[],"warnings":["<b>w</b>"],
 "artifacts":["page.html","large.inp","drawing.svg","field.vtu","report.pdf","linked.csv","passwd.csv","pipe.json",
 "folder.json","../outside.csv","..","/etc/passwd","a/b","page html","-rf","surface.json"],
 "statistics":{},"provenance":{"version":"0.1.0","spec_hash":""}}
DOC
'
start_daemon --workers 1 --retry-delay 0.1 --solver "$(solver "$BODY_OF_SOLVER")"
name='</title><script>alert(1)</script><img src=x onerror=alert(1)>=1+1'
id=$(submit "$(job ".name = \"$name\" | .labels.x = \"<svg onload=alert(1)>\"")")
check "it ends" succeeded "$(wait_state "$id" 'succeeded|failed')"

# One that asks for much and takes nothing of it.
exec 5<> "/dev/tcp/127.0.0.1/$PORT"
printf 'GET /api/v1/jobs/%s/artifacts/large.inp HTTP/1.1\r\nHost: localhost\r\n\r\n' "$id" >&5
asked=$SECONDS

# Files: only plain names of regular files of its folder, saved and never shown.
fetch GET "/api/v1/jobs/$id"
check "files that are listed" "-rf drawing.svg field.vtu large.inp page.html report.pdf" \
  "$(field '[.links.artifacts[] | sub(".*/"; "")] | sort | join(" ")')"
for file in page.html drawing.svg field.vtu report.pdf; do
  fetch GET "/api/v1/jobs/$id/artifacts/$file"
  check "$file" "200 application/octet-stream attachment; filename=\"$file\" nosniff" \
    "$CODE $(header Content-Type) $(header Content-Disposition) $(header X-Content-Type-Options)"
  check_match "policy of $file" "default-src 'none'; sandbox" "$(header Content-Security-Policy)"
done
for path in linked.csv passwd.csv pipe.json folder.json outside.csv job.json result.json log.txt \
  surface.json page.html%00 x; do
  fetch GET "/api/v1/jobs/$id/artifacts/$path" -m 5
  check_match "no file $path" '^(404|400)$' "$CODE"
done
for path in ..%2foutside.csv ..%2F..%2F..%2Fpneulab.db %2e%2e%2foutside.csv %2e%2e/outside.csv ../outside.csv \
  ..%5coutside.csv ..%c0%afoutside.csv %252e%252e%252foutside.csv . .. %2e .%2e; do
  fetch GET "/api/v1/jobs/$id/artifacts/$path"
  check_match "path $path" '^(404|400)$' "$CODE"
done
for query in attempt=../1 attempt=1%2f..%2f1 attempt=-1 attempt=1%00 attempt=99999999999999999999; do
  fetch GET "/api/v1/jobs/$id/log?$query"
  check "log?$query" 400 "$CODE"
done
moved=$(submit "$(job '.name = "moved"')")
check "a folder that became a link" succeeded "$(wait_state "$moved" 'succeeded|failed')"
fetch GET "/api/v1/jobs/$moved/artifacts/page.html"
check "is not followed" 404 "$CODE"
pipe=$(submit "$(job '.name = "pipe"')")
check "a pipe for a surface" succeeded "$(wait_state "$pipe" 'succeeded|failed')"
fetch GET "/api/v1/jobs/$pipe/plots/deformed.png" -m 5
check_match "keeps no picture waiting" '^(404|422)$' "$CODE"

# Texts: as they were in JSON, escaped in the table, unable to forge lines or to be run.
fetch GET "/api/v1/jobs/$id"
check "the name" "$name" "$(field .name)"
check "as JSON" "application/json nosniff" "$(header Content-Type) $(header X-Content-Type-Options)"
fetch GET "/api/v1/jobs/$id/samples.csv"
check "formulas are disarmed" "pressure_kPa,'=cmd|/c calc,note 0,'+1,'@SUM(A1)" \
  "$(tr -d '\r' <<< "$BODY" | paste -sd' ')"
fetch GET "/api/v1/jobs/$id/log"
check "the worker's log is plain text" "200 text/plain; charset=utf-8 nosniff" \
  "$CODE $(header Content-Type) $(header X-Content-Type-Options)"
fetch GET "/api/v1/jobs/$id/plots/angle.png"
check "a plot with that name" "200 image/png" "$CODE $(header Content-Type)"
check "no line of the daemon's log is forged" 0 "$(grep -c '^2026-01-01' "$WORK/stderr")"
check "nor has it control characters" 0 "$(grep -c "$(printf '[\001-\010\013-\037\177]')" "$WORK/stderr")"
for path in '/api/v1/jobs?label.x=%0d%0aSet-Cookie:%20a=b' '/api/v1/jobs/%0d%0aX:%20y' '/%0d%0aX:%20y'; do
  fetch GET "$path"
  check "$path" "400" "$CODE$(header Set-Cookie)$(header X)"
done
fetch GET '/api/v1/jobs?state=<script>alert(1)</script>'
check "markup in a refusal" "400 application/problem+json" "$CODE $(header Content-Type)"
# open_connections: how many there are beside the one that asks.
open_connections() {
  curl -s "$URL/metrics" | awk '/^pneulab_http_connections / { print $2 - 1 }'
}
while [ "$(open_connections)" != 0 ] && [ $((SECONDS - asked)) -lt 25 ]; do
  sleep 0.5
done
check "who takes nothing of an answer is cut off" 0 "$(open_connections)"
check "after its time" true "$([ $((SECONDS - asked)) -ge 11 ] && echo true)"
exec 5>&-
finish
