#!/bin/bash
# What a client may keep: tags of contents, answers without a body while they hold; and queries that
# an operation does not have.
. "$(dirname "$0")/lib.sh"
start_daemon --workers 1 --solver "$(solver 'result succeeded')"
id=$(submit)
wait_state "$id" succeeded > /dev/null

for path in "/api/v1/jobs/$id/document" "/api/v1/jobs/$id/result" "/api/v1/jobs/$id/samples.csv" \
  "/api/v1/jobs/$id/artifacts/surface.json" "/api/v1/jobs/$id/plots/angle.png" \
  "/api/v1/plots/overlay.png?jobs=$id" /api/v1/schemas/job /api/v1/schemas/result /openapi.json \
  /openapi.yaml / "/compare?jobs=$id" "/submit?from=$id" /docs /sign-in /static/style.css; do
  fetch GET "$path"
  check_match "GET $path has a tag" '^"[^"]+"$' "$(header ETag)"
  case $path in /docs | /sign-in | /static/*) control=no-cache ;; *) control="private, no-cache" ;; esac
  check "GET $path is asked for anew" "$control" "$(header Cache-Control)"
  etag=$(header ETag)
  fetch GET "$path" -H "If-None-Match: $etag"
  check "GET $path as known" "304 0 $etag" "$CODE ${#BODY} $(header ETag)"
  for known in "\"other\", W/$etag" '*'; do
    fetch GET "$path" -H "If-None-Match: $known"
    check "GET $path with $known" 304 "$CODE"
  done
  fetch HEAD "$path" --head -H "If-None-Match: $etag"
  check "HEAD $path as known" 304 "$CODE"
  for other in '"other"' "${etag%?}" "\"${etag//\"/}x\""; do
    fetch GET "$path" -H "If-None-Match: $other"
    check "GET $path with $other" 200 "$CODE"
  done
done

# Pages are sent packed to who can unpack them; a library may be kept for ever under its hash.
fetch GET /static/style.css
plain=$(sha256sum <<< "$BODY")
tag=$(header ETag)
check "no coding unasked" "Accept-Encoding " "$(header Vary) $(header Content-Encoding)"
fetch GET /static/style.css --compressed -H 'Accept-Encoding: gzip'
check "packed" "gzip $plain" "$(header Content-Encoding) $(sha256sum <<< "$BODY")"
check_match "under a tag of its own" "^${tag%?}-gz\"\$" "$(header ETag)"
fetch GET /static/style.css -H 'Accept-Encoding: gzip;q=0'
check "not packed where that is refused" "" "$(header Content-Encoding)"
for library in echarts three; do
  fetch GET "/static/vendor/$library.js"
  path=$(sed -n "s/^export \* from '\(.*\)';$/\1/p" <<< "$BODY")
  check_match "$library has its hash in its path" "^/static/vendor/$library-[0-9a-f]{16}\.js$" "$path"
  check "its name is asked for anew" no-cache "$(header Cache-Control)"
  curl -sS -o "$WORK/plain" "$URL$path"
  fetch GET "$path" -H "Accept-Encoding: gzip, br"
  check "$library comes packed" br "$(header Content-Encoding)"
  check_match "$library is kept" immutable "$(header Cache-Control)"
  check "$library has the hash" "$path" "/static/vendor/$library-$(sha256sum < "$WORK/plain" | cut -c 1-16).js"
  fetch GET "/static/vendor/$library.txt"
  check_match "$library has its licence" "$library [0-9.]+ \(" "$BODY"
done

# Tags tell contents apart.
fetch GET "/api/v1/jobs/$id/document"
etag=$(header ETag)
other=$(submit "$(job '.name = "another"')")
wait_state "$other" succeeded > /dev/null
fetch GET "/api/v1/jobs/$other/document" -H "If-None-Match: $etag"
check "the document of another job" 200 "$CODE"
fetch GET "/api/v1/jobs/$id/plots/angle.png"
etag=$(header ETag)
fetch GET "/api/v1/jobs/$other/plots/angle.png" -H "If-None-Match: $etag"
check "a plot with another title" 200 "$CODE"
for other in "jobs/$id/plots/angle.png?" "plots/overlay.png?jobs=$id&"; do
  fetch GET "/api/v1/$other"
  etag=$(header ETag)
  fetch GET "/api/v1/${other}theme=dark" -H "If-None-Match: $etag"
  check "a plot on a dark ground" 200 "$CODE"
  fetch GET "/api/v1/${other}width=400" -H "If-None-Match: $etag"
  check "a smaller plot" 200 "$CODE"
done
fetch GET "/api/v1/jobs/$id"
check "a job is never kept" "no-store " "$(header Cache-Control) $(header ETag)"
fetch GET "/api/v1/jobs/$id/plots/nothing.png" -H 'If-None-Match: "x"'
check "what is not there has no tag" "404 " "$CODE $(header ETag)"

# Every operation refuses a query parameter that it does not have.
while read -r method path; do
  fetch "$method" "$path?surplus=1" --data-binary ''
  check "$method $path with a query" "400 invalid_query" "$CODE $(field .code)"
done <<END
GET /api/v1/jobs
POST /api/v1/jobs
POST /api/v1/jobs:validate
GET /api/v1/jobs/$id
DELETE /api/v1/jobs/$id
POST /api/v1/jobs/$id/cancel
POST /api/v1/jobs/$id/retry
POST /api/v1/jobs/$id/hold
POST /api/v1/jobs/$id/release
GET /api/v1/jobs/$id/document
GET /api/v1/jobs/$id/result
GET /api/v1/jobs/$id/metrics
GET /api/v1/jobs/$id/samples.csv
GET /api/v1/jobs/$id/artifacts/surface.json
GET /api/v1/jobs/$id/attempts
GET /api/v1/jobs/$id/log
GET /api/v1/jobs/$id/plots/angle.png
GET /api/v1/plots/overlay.png
GET /api/v1/compare
GET /api/v1/database
GET /api/v1/materials
GET /api/v1/schemas/job
GET /api/v1/events
GET /api/v1/caller
GET /openapi.json
GET /openapi.yaml
GET /healthz
GET /readyz
GET /metrics
END
fetch GET "/jobs/$id?from=elsewhere"
check "a page has any query" 200 "$CODE"

# The description is the same in both notations.
fetch GET /openapi.json
check "OpenAPI as JSON" "application/json 3.1.0" "$(header Content-Type) $(field .openapi)"
check "nothing in it is elsewhere" 0 \
  "$(field '[.. | objects | .["$ref"]? | strings | select(startswith("#/") | not)] | length')"
finish
