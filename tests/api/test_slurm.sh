#!/bin/bash
# The daemon and a cluster that is played by a few scripts, which do what a real one does only on bad
# days: no answer, an answer that is lost, a refusal, tasks that vanish. Needs no Slurm.
# shellcheck disable=SC2016 # bodies of the stand-ins
. "$(dirname "$0")/lib.sh"

# ---- the stand-in -----------------------------------------------------------------------------
# A folder has a file of each task that runs, named JOB_TASK, with its name and process. Marks: `down`,
# no program answers; `mute`, sbatch submits and fails; `deaf`, it never comes to submit; `slow`, it
# submits and never answers; `full`, tasks stay pending; `called`, a line for each sbatch.
FAKE=$WORK/fake
mkdir -p "$FAKE/bin" "$FAKE/tasks"
stand_in() {
  { printf '#!/bin/bash\nFAKE=%q\n' "$FAKE"
    cat <<'END'
if [ -e "$FAKE/down" ]; then echo "error: Unable to contact slurm controller (connect failure)" >&2; exit 1; fi
END
    cat; } > "$FAKE/bin/$1"
  chmod +x "$FAKE/bin/$1"
}
stand_in sbatch <<'END'
for word; do
  case $word in
    --job-name=*) name=${word#*=} ;;
    --array=0-*) last=${word#*-} last=${last##*-} ;;
    --partition=gone) echo "sbatch: error: invalid partition specified: gone" >&2; exit 1 ;;
    --*) ;;
    *) break ;;
  esac
  shift
done
echo "$name" >> "$FAKE/called"
[ -e "$FAKE/deaf" ] && exec sleep 60
job=$(($(cat "$FAKE/last" 2> /dev/null || echo 0) + 1))
echo "$job" > "$FAKE/last"
for task in $(seq 0 "$last"); do
  echo "$name 0" > "$FAKE/tasks/${job}_$task"
  [ -e "$FAKE/full" ] && continue
  (
    export SLURM_ARRAY_JOB_ID=$job SLURM_ARRAY_TASK_ID=$task
    setsid sh "$@" & echo "$name $!" > "$FAKE/tasks/${job}_$task"
    wait; rm -f "$FAKE/tasks/${job}_$task"
  ) > /dev/null 2>&1 < /dev/null &
done
[ -e "$FAKE/mute" ] && { echo "sbatch: error: Socket timed out on send/recv operation" >&2; exit 1; }
[ -e "$FAKE/slow" ] && exec sleep 60
echo "$job"
END
stand_in squeue <<'END'
wanted= format=
for word; do
  case $last in --name) wanted=$word ;; esac
  case $word in --format=%F) format=short ;; esac
  last=$word
done
for file in "$FAKE"/tasks/*; do
  [ -e "$file" ] || continue
  read -r name pid < "$file"
  task=${file##*/}
  [ -z "$wanted" ] || [ "$wanted" = "$name" ] || continue
  state=RUNNING reason=None
  [ "$pid" = 0 ] && state=PENDING reason=Resources
  if [ "$format" = short ]; then echo "${task%_*}"; else echo "${task%_*}|${task#*_}|$state|$reason|n1|main|$name"; fi
done
END
stand_in scancel <<'END'
signal=KILL
for word; do
  case $word in
    --signal=*) signal=${word#*=} ;;
    --*) ;;
    *) read -r _ pid < "$FAKE/tasks/$word" || continue
       if [ "$pid" = 0 ]; then rm "$FAKE/tasks/$word"
       elif [ "$signal" = USR1 ]; then kill -USR1 "$pid"
       else kill -KILL -- "-$pid"; fi ;;
  esac
done
END
stand_in sinfo <<< 'echo 0/4/0/4'
export PATH=$FAKE/bin:$PATH

# ---- jobs -------------------------------------------------------------------------------------
# Those with a name wait for a file go-NAME, for being cancelled, or for the end of the test.
solver 'name=$(jq -r ".name // empty" "$job")
trap "asked=1" USR1
while [ -n "$name" ] && [ -d "$WORK" ] && [ ! -e "$WORK/go-$name" ]; do
  [ -n "$asked" ] && [ -e "${job%/*}/cancel" ] && exit 5
  sleep 0.05 & wait $!
done
result succeeded' > /dev/null
sed -i "2iWORK='$WORK'" "$WORK/solver"
# The signal comes to the process that solves the bundle: it is passed on to the member.
sed -i 's/^  (body) > "$folder\/result.part"$/  (body) > "$folder\/result.part" \& worker=$!; trap "kill -USR1 $worker" USR1; wait "$worker"; while kill -0 "$worker" 2> \/dev\/null; do wait "$worker"; done/' "$WORK/solver"
sed -i 's/^jq -r .\.members\[\]. "$bundle" | while read -r folder; do$/while read -r folder; do/; s/^done$/done < <(jq -r ".members[]" "$bundle")/' "$WORK/solver"
small() {
  jq -nc --arg name "$1" '{ kind: "verify", case: "patch-test" } + if $name == "" then {} else { name: $name } end'
}
start_cluster() {
  start_daemon --executor slurm --solver "$WORK/solver" --retry-delay 0 --memory-limit 0
}
calls() { wc -l < "$FAKE/called"; }
attempts() { sql "select group_concat(outcome || ':' || reason_code, ' ') from attempt where job_id = $1"; }
place() { curl -s "$URL/api/v1/jobs/$1" | jq -r "$2"; }
await() {
  local end=$((SECONDS + 60))
  until "${@:2}" | grep -qx -- "$1" || [ "$SECONDS" -gt "$end" ]; do sleep 0.1; done
  "${@:2}"
}

# ---- no answer --------------------------------------------------------------------------------
touch "$FAKE/down" "$FAKE/called"
start_cluster
id=$(submit "$(small "")")
check "a job waits and says why" unreachable "$(await unreachable place "$id" .cluster.reason)"
check_match "in the words of the program" "Unable to contact" "$(place "$id" .cluster.message)"
check "it is in the queue" queued "$(place "$id" .state)"
fetch GET /readyz
check "the daemon is ready" 200 "$CODE"
rm "$FAKE/down"
check "it goes on by itself" succeeded "$(wait_state "$id" succeeded)"
check "at the first attempt" succeeded: "$(attempts "$id")"
check "nothing is left on the shared disk" 0 "$(await 0 eval 'find "$DATA/cluster" -mindepth 1 -type d | wc -l')"

# ---- an answer that is lost -------------------------------------------------------------------
touch "$FAKE/mute"
before=$(calls)
id=$(submit "$(small mute)")
sleep 1
rm "$FAKE/mute"
check "what was submitted without an answer runs" running "$(wait_state "$id" running)"
touch "$WORK/go-mute"
check "and succeeds" succeeded "$(wait_state "$id" succeeded)"
check "submitted once" 1 "$(($(calls) - before))"

# ---- the daemon dies on the way ---------------------------------------------------------------
before=$(calls)
id=$(submit "$(small adopted)")
check "a job runs" running "$(wait_state "$id" running)"
stop_daemon KILL
start_cluster
touch "$WORK/go-adopted"
check "the next daemon takes in what it brings" succeeded "$(wait_state "$id" succeeded)"
check "of the same attempt" succeeded: "$(attempts "$id")"
check "submitted once" 1 "$(($(calls) - before))"

touch "$FAKE/slow"
before=$(calls)
id=$(submit "$(small slow)")
await $((before + 1)) calls > /dev/null
sleep 0.5
stop_daemon KILL
rm "$FAKE/slow"
start_cluster
touch "$WORK/go-slow"
check "what was submitted when the daemon died is found by its name" succeeded "$(wait_state "$id" succeeded)"
check "and submitted once" "1 succeeded:" "$(($(calls) - before)) $(attempts "$id")"

touch "$FAKE/deaf"
before=$(calls)
id=$(submit "$(small "")")
await $((before + 1)) calls > /dev/null
stop_daemon KILL
rm "$FAKE/deaf"
start_cluster
check "what did not get there is submitted" succeeded "$(wait_state "$id" succeeded)"
check "under the same name" 1 "$(tail -n 2 "$FAKE/called" | sort -u | wc -l)"

# ---- refusals ---------------------------------------------------------------------------------
id=$(submit "$(small "" | jq -c '.labels = { partition: "gone" }')")
check "a partition that is not there fails the job that asks for it" failed "$(wait_state "$id" failed)"
check "with the reason" cluster_refuses "$(place "$id" .reason_code)"
check_match "in the words of the program" "invalid partition" "$(place "$id" .message)"
id=$(submit "$(small "" | jq -c '.labels = { executor: "local" }')")
before=$(calls)
check "a job may ask for this machine" succeeded "$(wait_state "$id" succeeded)"
check "without the cluster" "$before" "$(calls)"

# ---- ends -------------------------------------------------------------------------------------
id=$(submit "$(small cancelled)")
check "a job runs" running "$(wait_state "$id" running)"
start=$(date +%s%N)
fetch POST "/api/v1/jobs/$id/cancel" -H 'Prefer: wait=30'
check "it is cancelled" cancelled "$(field .state)"
check "within two seconds" true "$(jq -n "$(($(date +%s%N) - start)) < 2e9")"

id=$(submit "$(small lost)")
check "a job runs" running "$(wait_state "$id" running)"
read -r _ pid < <(cat "$FAKE"/tasks/*)
kill -KILL -- "-$pid"
touch "$WORK/go-lost"
check "one whose task vanishes runs again" succeeded "$(wait_state "$id" succeeded)"
check "under another number" "worker_lost:task_failed succeeded:" \
  "$(attempts "$id" | sed 's/requeued:task_lost/worker_lost:task_failed/')"

touch "$FAKE/full"
id=$(submit "$(small "")")
check "a job waits on the cluster" pending "$(await pending place "$id" .cluster.state)"
check "with its reason" Resources "$(await Resources place "$id" .cluster.reason)"
fetch POST "/api/v1/jobs/$id/hold"
check "it can be held" held "$(field .state)"
check "and is taken from the cluster" 0 "$(await 0 eval 'find "$FAKE/tasks" -type f | wc -l')"
fetch POST "/api/v1/jobs/$id/release"
check "it comes back" pending "$(await pending place "$id" .cluster.state)"
fetch POST "/api/v1/jobs/$id/cancel" -H 'Prefer: wait=30'
check "and is cancelled there" cancelled "$(field .state)"
check "for good" 0 "$(await 0 eval 'find "$FAKE/tasks" -type f | wc -l')"
rm "$FAKE/full"
check "the metrics are in order" "" "$(curl -s "$URL/metrics" | python3 "$(dirname "$0")/check_metrics.py")"
check "the cluster answers" 1 "$(curl -s "$URL/metrics" | sed -n 's/^pneulab_cluster_reachable //p')"
finish
