#!/bin/bash
# The database file: what is refused at the start and how, backups beside a running daemon and
# without one, restoring, checking, and the age and size of files.
. "$(dirname "$0")/lib.sh"
SOLVER=$(solver 'result succeeded')

# refused WHAT STATUS PATTERN: the daemon does not start on $DATA, says why, and changes nothing.
refused() {
  local before after
  before=$(cd "$DATA" && sha256sum pneulab.db 2> /dev/null)
  timeout 20 "$BIN/pneulabd" --data "$DATA" --listen 127.0.0.1:0 > /dev/null 2> "$WORK/refusal"
  check "$1: exit status" "$2" $?
  check_match "$1: advice" "$3" "$(cat "$WORK/refusal")"
  after=$(cd "$DATA" && sha256sum pneulab.db 2> /dev/null)
  check "$1: the file is as it was" "$before" "$after"
}

start_daemon --workers 2 --solver "$SOLVER"
for n in 1 2 3; do submit "$(job ".name = \"n$n\"")" -H 'Prefer: wait=20' > /dev/null; done

# A snapshot over HTTP, and one by the command line, while jobs go on.
fetch GET /api/v1/database
check "snapshot" "200 application/vnd.sqlite3" "$CODE $(header Content-Type)"
check "its content" "ok 3" "$(sqlite3 "$WORK/body" 'pragma integrity_check; select count(*) from result' | paste -sd' ')"
check "no copy is left" "" "$(ls "$DATA/tmp")"
for n in 1 2 3 4 5 6 7 8; do curl -s -o "$WORK/copy$n" "$URL/api/v1/database" & copies[n]=$!; done
wait "${copies[@]}"
check "copies at the same time" "3 3 3 3 3 3 3 3" \
  "$(for n in 1 2 3 4 5 6 7 8; do sqlite3 "$WORK/copy$n" 'select count(*) from job'; done | paste -sd' ')"
"$BIN/pneulabd" --data "$DATA" --backup "$WORK/backup.db" > "$WORK/said" 2>&1
check "backup beside the daemon" 0 $?
check "the backup" "ok 3 delete" \
  "$(sqlite3 "$WORK/backup.db" 'pragma integrity_check; select count(*) from job; pragma journal_mode' | paste -sd' ')"
"$BIN/pneulabd" --data "$DATA" --backup "$WORK/backup.db" 2> "$WORK/said"
check "an existing file" 3 $?
check_match "its advice" "--force" "$(cat "$WORK/said")"
"$BIN/pneulabd" --data "$DATA" --backup "$WORK/backup.db" --force > /dev/null
check "replaced when asked" 0 $?
"$BIN/pneulabd" --data "$DATA" --backup /nonexistent/backup.db 2> "$WORK/said"
check "no such directory" 1 $?
"$BIN/pneulabd" --data "$DATA" --check > "$WORK/said"
check "check beside the daemon" "0 $DATA/pneulab.db is sound" "$? $(cat "$WORK/said")"
"$BIN/pneulabd" --data "$DATA" --restore "$WORK/backup.db" --force 2> "$WORK/said"
check "no restoring under a daemon" 4 $?
check "nothing half done is left" "" "$(find "$WORK" "$DATA" -maxdepth 1 -name '*.part-*')"
curl -s "$URL/api/v1/jobs?sort=id" | jq -S . > "$WORK/list-before"
curl -s "$URL/api/v1/jobs/2/result" > "$WORK/result-before"
curl -s "$URL/api/v1/jobs/2/artifacts/surface.json" > "$WORK/artifact-before"
stop_daemon TERM
check "the daemon ends" 0 "$STATUS"
"$BIN/pneulabd" --data "$DATA" --backup "$WORK/offline.db" > /dev/null
check "backup without a daemon" "0 3" "$? $(sqlite3 "$WORK/offline.db" 'select count(*) from job')"

# Restored into a new directory, with the files of the jobs beside it: the same answers.
mkdir "$WORK/new"
cp -r "$DATA/attempts" "$WORK/new/attempts"
"$BIN/pneulabd" --data "$WORK/new" --restore "$WORK/backup.db" > /dev/null
check "restore" 0 $?
OLD=$DATA DATA=$WORK/new
start_daemon --workers 1 --solver "$SOLVER"
curl -s "$URL/api/v1/jobs?sort=id" | jq -S . | cmp -s - "$WORK/list-before"
check "the same list" 0 $?
curl -s "$URL/api/v1/jobs/2/result" | cmp -s - "$WORK/result-before"
check "the same result" 0 $?
curl -s "$URL/api/v1/jobs/2/artifacts/surface.json" | cmp -s - "$WORK/artifact-before"
check "the same file" 0 $?
check "the next id" 4 "$(submit)"
wait_state 4 succeeded > /dev/null
stop_daemon TERM
"$BIN/pneulabd" --data "$DATA" --restore "$WORK/backup.db" 2> "$WORK/said"
check "a database that is there" 3 $?
"$BIN/pneulabd" --data "$DATA" --restore "$WORK/backup.db" --force > /dev/null
check "put aside when asked" "0 3 4" \
  "$? $(sql 'select count(*) from job') $(sqlite3 "$DATA/replaced-pneulab.db" 'select count(*) from job')"
start_daemon --workers 1 --solver "$SOLVER"
for _ in $(seq 50); do [ -d "$DATA/attempts/4-1" ] || break; sleep 0.1; done
check "files of a job that the backup does not know are gone" no "$([ -d "$DATA/attempts/4-1" ] && echo yes || echo no)"
check "those of the others are there" yes "$([ -d "$DATA/attempts/3-1" ] && echo yes || echo no)"
stop_daemon TERM
DATA=$OLD

# Damaged, foreign, newer and missing databases.
damage() { rm -rf "${DATA:?}"; mkdir "$DATA"; cp "$WORK/backup.db" "$DATA/pneulab.db"; }
damage; printf 'x' | dd of="$DATA/pneulab.db" conv=notrunc status=none
refused "bad header" 3 'does not begin like.*--restore FILE'
damage; truncate -s 20000 "$DATA/pneulab.db"
refused "cut off" 3 'cut off.*\.recover'
damage; head -c 40960 /dev/urandom | dd of="$DATA/pneulab.db" bs=4096 seek=3 conv=notrunc status=none
refused "pages overwritten" 3 'is damaged: .*\.recover'
"$BIN/pneulabd" --data "$DATA" --check 2> "$WORK/said"
check "--check finds it too" 3 $?
"$BIN/pneulabd" --data "$DATA" --backup "$WORK/bad.db" 2> "$WORK/said"
check "no backup of a damaged database" "3 no" "$? $([ -e "$WORK/bad.db" ] && echo yes || echo no)"
damage; sqlite3 "$DATA/pneulab.db" 'pragma user_version = 9999'
refused "newer" 3 'schema 9999.*newer pneulabd.*backup made before'
rm -rf "${DATA:?}"; mkdir "$DATA"
sqlite3 "$DATA/pneulab.db" 'create table bookmarks(url)'
refused "foreign" 3 'another program'
rm "$DATA/pneulab.db"; mkdir -p "$DATA/attempts/1-1"
refused "missing beside files of jobs" 3 'missing or empty'
: > "$DATA/pneulab.db"
refused "empty beside files of jobs" 3 'missing or empty'
rm "$DATA/pneulab.db"; mkdir "$DATA/pneulab.db"
refused "a directory" 3 'not a regular file'
"$BIN/pneulabd" --data "$WORK/nowhere" --check 2> "$WORK/said"
check "nothing to check" 1 $?
"$BIN/pneulabd" --data "$DATA" --check --backup "$WORK/x.db" 2> "$WORK/said"
check "two things at once" 2 $?

# A log that is left by a crash is taken in; one with a torn end loses only that end.
rm -rf "${DATA:?}"
start_daemon --workers 1 --solver "$SOLVER"
for _ in 1 2 3; do submit > /dev/null; done
stop_daemon KILL
printf 'torn' >> "$DATA/pneulab.db-wal"
start_daemon --workers 1 --solver "$SOLVER"
check "jobs are in the log" 3 "$(curl -s "$URL/api/v1/jobs" | jq '.jobs | length')"
for id in 1 2 3; do wait_state $id succeeded > /dev/null; done

# Files by age and by size: they go, what the database knows stays.
mkdir -p "$DATA/attempts/77-1" "$DATA/attempts/notes"
stop_daemon TERM
start_daemon --workers 1 --solver "$SOLVER" --keep-files-days 0.00001
for _ in $(seq 50); do [ "$(ls "$DATA/attempts")" = notes ] && break; sleep 0.1; done
fetch GET /api/v1/jobs/3/artifacts/surface.json
check "an old file" "410 files_removed" "$CODE $(field .code)"
check_match "its reason" 'older than.*--keep-files-days' "$(field .detail)"
fetch GET /api/v1/jobs/3/log
check "its log" 410 "$CODE"
fetch GET /api/v1/jobs/3/result
check "the result stays" "200 64.25" "$CODE $(field .metrics.bending_angle_deg)"
check "folders" notes "$(ls "$DATA/attempts")"
stop_daemon TERM
start_daemon --workers 1 --solver "$SOLVER" --keep-files-size 1
for _ in 1 2 3 4; do submit "$(job)" -H 'Prefer: wait=20' > /dev/null; done
check "small enough" 200 "$(curl -s -o /dev/null -w '%{http_code}' "$URL/api/v1/jobs/4/log")"
stop_daemon TERM
for id in 4 5 6 7; do head -c 400000 /dev/zero > "$DATA/attempts/$id-1/out/big"; done
sql 'update job set files_bytes = null'
start_daemon --workers 1 --solver "$SOLVER" --keep-files-size 1
for _ in $(seq 50); do [ -d "$DATA/attempts/5-1" ] || break; sleep 0.1; done
check "the oldest two had to go" "6-1 7-1" "$(find "$DATA/attempts" -name '[4-7]-1' -printf '%f\n' | sort | paste -sd' ')"
fetch GET /api/v1/jobs/5/artifacts/surface.json
check_match "why" 'newer files needed the room' "$(field .detail)"
fetch DELETE /api/v1/jobs/7
check "deleting one" "204 no" "$CODE $([ -d "$DATA/attempts/7-1" ] && echo yes || echo no)"
finish
