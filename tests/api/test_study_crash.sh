#!/bin/bash
# A study of many light members, and a daemon that is killed again and again meanwhile: every member
# is stored once and has one result. Members that fail are data.
. "$(dirname "$0")/lib.sh"
limit=2048
grep -aqE '__(asan|tsan)_init' "$BIN/pneulab-solve" && limit=0

# A stand-in that takes a moment, so that there is something to kill, and fails where the mass is
# large.
solver '[[ $(< "$job") =~ \"mass\":\ \"([0-9]+)([0-9.]*) ]]
mass=${BASH_REMATCH[1]}${BASH_REMATCH[2]}
status=succeeded reason= message= metrics="{\"mass_g\":$mass}"
[ "${BASH_REMATCH[1]}" -ge 69 ] && status=diverged reason=diverged message="too heavy" metrics={}
printf "{\"status\":\"%s\",\"reason\":\"%s\",\"message\":\"%s\",\"metrics\":%s,\"samples\":[],\"provenance\":{\"version\":\"0.1.0\"}}" \
  "$status" "$reason" "$message" "$metrics"
[ "$status" = succeeded ] || exit 3' > /dev/null

start_daemon --solver "$WORK/solver" --memory-limit "$limit" --workers 2
# Every tenth member diverges.
id=$(submit "$(light_study "three hundred" 300)")
for round in 1 2 3 4; do
  for _ in $(seq 400); do
    done=$(sql "select count(*) from job where study_id = $id and finished_ms is not null")
    [ "$done" -ge $((round * 12)) ] && break
    sleep 0.02
  done
  stop_daemon KILL
  start_daemon --solver "$WORK/solver" --memory-limit "$limit" --workers 2
done
check "the study goes on to its end" succeeded "$(wait_state "$id" 'succeeded|failed|timed_out' 120)"
check "it was taken up after each kill" 5 "$(sql "select count(*) from attempt where job_id = $id")"
check "all members are there once" "300 300" \
  "$(sql "select count(*) || ' ' || count(distinct member) from job where study_id = $id")"
heavy=$(sql "select count(*) from study_value where study_id = $id and position = 0 and number >= 69")
check_match "some of them are too heavy" '^1[0-9]$' "$heavy"
check "every other one has one result" "$((300 - heavy))" \
  "$(sql "select count(*) from result join job on id = job_id where study_id = $id and state = 'succeeded'")"
check "which is its own" 0 \
  "$(sql "select count(*) from study_$id where state = 'succeeded' and mass_g_2 <> mass_g")"
fetch GET "/api/v1/jobs/$id/result"
check "the study has them all" "300 $((300 - heavy)) $heavy" \
  "$(field '.metrics | "\(.designs) \(.solved) \(.failed)"')"
check "and the reasons of those that failed" "$heavy" \
  "$(field '[.members[] | select(.reason == "diverged" and .message == "too heavy")] | length')"
check "no member is left over" 0 "$(sql "select count(*) from job where finished_ms is null")"
finish
