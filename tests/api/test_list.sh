#!/bin/bash
# Listing, filtering, sorting and paging of jobs.
. "$(dirname "$0")/lib.sh"
start_daemon --workers 2 --solver "$(solver '
case $(jq -r .name "$job") in
  *fails*) result diverged limit_point "The load passed a limit point."; exit 3 ;;
  *) result succeeded ;;
esac')"
for i in 1 2 3 4 5 6 7; do
  submit "$(job ".name = \"job $((10 - i))\" | .labels = { round: \"$((i % 2))\", \"a b\": \"x&y=$i\" }")" > /dev/null
done
submit "$(job '.name = "this fails"')" > /dev/null
for i in 1 2 3 4 5 6 7 8; do wait_state $i 'succeeded|failed' > /dev/null; done

# ids QUERY: the ids of one page.
ids() {
  fetch GET "/api/v1/jobs$1"
  field '[.jobs[].id] | join(" ")'
}
check "newest first" "8 7 6 5 4 3 2 1" "$(ids '')"
check "oldest first" "1 2 3 4 5 6 7 8" "$(ids '?sort=id')"
check "by name" "7 6 5 4 3 2 1 8" "$(ids '?sort=name')"
check "by name, descending" "8 1 2 3 4 5 6 7" "$(ids '?sort=-name')"
check "by state" "8 1 2 3 4 5 6 7" "$(ids '?sort=state')"
check "by creation" "1 2 3 4 5 6 7 8" "$(ids '?sort=created')"
check "failed only" "8" "$(ids '?state=failed')"
check "several states" "8 7 6 5 4 3 2 1" "$(ids '?state=failed,succeeded')"
check "none queued" "" "$(ids '?state=queued')"
check "kind" "8 7 6 5 4 3 2 1" "$(ids '?kind=response')"
check "another kind" "" "$(ids '?kind=snap')"
check "label" "7 5 3 1" "$(ids '?label.round=1')"
check "label with escapes" "3" "$(ids '?label.a%20b=x%26y%3D3')"
check "two labels" "3" "$(ids '?label.a+b=x%26y%3D3&label.round=1')"
check "labels that exclude each other" "" "$(ids '?label.a+b=x%26y%3D3&label.round=0')"

# pages QUERY: all ids by following the cursor, pages separated by bars.
pages() {
  local cursor='' out=''
  while :; do
    fetch GET "/api/v1/jobs?limit=3$1${cursor:+&cursor=$cursor}"
    out+="$(field '[.jobs[].id] | join(" ")')"
    cursor=$(field '.next // empty')
    [ -n "$cursor" ] || break
    out+=' | '
  done
  printf '%s' "$out"
}
check "pages" "8 7 6 | 5 4 3 | 2 1" "$(pages '')"
check "pages by name" "7 6 5 | 4 3 2 | 1 8" "$(pages '&sort=name')"
check "pages of a filter" "7 5 3 | 1" "$(pages '&label.round=1')"
check "pages by state" "8 1 2 | 3 4 5 | 6 7" "$(pages '&sort=state')"
fetch GET "/api/v1/jobs?cursor=1"
check "the last page has no cursor" null "$(field .next)"
fetch GET '/api/v1/jobs?limit=3'
cursor=$(field .next)
submit > /dev/null
check "a new job does not shift the next page" "5 4 3" "$(ids "?limit=3&cursor=$cursor")"

for query in limit=0 limit=501 limit=x limit=-1 limit= cursor=x cursor=0 state=nonsense sort=size sort=- \
  unknown=1 label.=1; do
  fetch GET "/api/v1/jobs?$query"
  check "refused: $query" "400 invalid_query" "$CODE $(field .code)"
done
fetch GET "/api/v1/jobs?$(for i in 1 2 3 4 5 6 7 8 9; do printf 'label.%d=x&' $i; done)"
check "too many labels" 400 "$CODE"
fetch GET "/api/v1/jobs?kind=%27%20OR%20%271%27%3D%271"
check "no way into the SQL" "200 0" "$CODE $(field '.jobs | length')"

# A failed solve is data.
fetch GET /api/v1/jobs/8
check "a solve that stopped early" "failed limit_point 64.25" "$(field '.state + " " + .reason_code') $(field .metrics.bending_angle_deg)"
check "its message" "The load passed a limit point." "$(field .message)"
fetch GET /api/v1/jobs/8/result
check "its result is kept" "200 diverged" "$CODE $(field .status)"
finish
