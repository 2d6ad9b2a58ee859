#!/bin/bash
# A study through the daemon with two workers, as people send it: designs an hour.
#   bench_study.sh STUDY.json OUT.json [MEMBERS]
# MEMBERS: a sampling that spreads is cut to so many, a list to its first ones. Told are wall time
# and, since other programs may run beside, what the workers used: designs an hour on two cores that
# had nothing else to do. Needs curl, jq, sqlite3; BIN: where the programs are.
set -eu
study=$1 out=$2 members=${3:-0}
BIN=${BIN:-$PWD}
for tool in curl jq sqlite3; do
  command -v $tool > /dev/null || { echo "bench_study: $tool is not installed"; exit 0; }
done
work=$(mktemp -d)
daemon=
cleanup() {
  if [ -n "$daemon" ]; then kill "$daemon" 2> /dev/null || true; wait "$daemon" 2> /dev/null || true; fi
  rm -rf "$work"
}
trap cleanup EXIT
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1

"$BIN/pneulab-solve" --embed "$study" | jq -c --argjson members "$members" 'if $members == 0 then .
  elif .size then .size = $members else .designs |= .[:$members] end' > "$work/study.json"
"$BIN/pneulabd" --data "$work/data" --listen 127.0.0.1:0 --workers 2 > "$work/stdout" 2> "$work/stderr" &
daemon=$!
url=
for _ in $(seq 200); do
  url=$(sed -n 's/^listening on //p' "$work/stdout")
  [ -n "$url" ] && break
  sleep 0.05
done
[ -n "$url" ] || { cat "$work/stderr"; exit 1; }
start=$(date +%s.%N)
id=$(curl -sS --fail-with-body --data-binary @"$work/study.json" "$url/api/v1/jobs" | jq .id)
state=queued
while ! [[ $state =~ succeeded|failed|cancelled|timed_out ]]; do
  sleep 1
  state=$(curl -sS "$url/api/v1/jobs/$id" | jq -r .state)
done
end=$(date +%s.%N)
sqlite3 -readonly "$work/data/pneulab.db" "select json_object('members', count(*),
    'solved', sum(job.state = 'succeeded'), 'cpu_s', sum(attempt.cpu_s),
    'warm', sum(coalesce(json_extract(result.document, '\$.statistics.warm_start'), 0)),
    'factorizations', avg(json_extract(result.document, '\$.statistics.factorizations')))
  from job join attempt on attempt.job_id = job.id left join result on result.job_id = job.id
  where job.study_id = $id" |
  jq --arg state "$state" --argjson wall "$(jq -n "$end - $start")" '. + { state: $state, wall_s: $wall,
    designs_an_hour: (3600 * .members / $wall), designs_an_hour_of_two_cores: (7200 * .members / .cpu_s) }' > "$out"
jq -r '"\(.members) designs (\(.solved) solved, \(.warm) from a neighbour): \(.wall_s | round) s, " +
  "\(.designs_an_hour | round) an hour; \(.cpu_s | round) s of workers, " +
  "\(.designs_an_hour_of_two_cores | round) an hour of two cores"' "$out"
