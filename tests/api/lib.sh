# shellcheck shell=bash disable=SC2034,SC2120
# Shared by the tests of the API: a real daemon on a free port with a data directory of its own,
# and checks that count. Source it; it cleans up when the test ends.
# Needs: bash, curl, jq, sqlite3. Binaries: $BIN (default: the current directory).
set -u
BIN=${BIN:-$PWD}
WORK=$(mktemp -d)
DATA=$WORK/data
DAEMON_PID=
FAILED=0
PASSED=0

# Fontconfig keeps what it has read until the end of the process; GLib has locks of its own, which
# ThreadSanitizer does not see.
echo "leak:libfontconfig" > "$WORK/lsan.supp"
for library in glib-2.0 gobject-2.0 pango-1.0 pangocairo-1.0 pangoft2-1.0 fontconfig cairo \
  harfbuzz freetype pixman-1; do
  printf "race:lib%s.so\\ncalled_from_lib:lib%s.so\\n" "$library" "$library"
done > "$WORK/tsan.supp"
export LSAN_OPTIONS="suppressions=$WORK/lsan.supp:print_suppressions=0"
export TSAN_OPTIONS="suppressions=$WORK/tsan.supp"

for tool in curl jq sqlite3; do
  command -v $tool > /dev/null || { echo "SKIP: $tool is not installed"; exit 77; }
done

# What the tests of this folder send to URL passes a proxy that keeps it, when API_RECORD names a
# folder for that: tests/contract compares it with the description of the API. PORT is the daemon's.
RECORDER_PID=
start_recorder() {
  local here
  here=$(dirname "$0")
  if [ -n "$RECORDER_PID" ] || [ -z "${API_RECORD:-}" ] || [ ! -f "$here/lib.sh" ] ||
    ! command -v node > /dev/null; then
    return
  fi
  mkdir -p "$API_RECORD"
  # Not a child, for which a plain `wait` would wait.
  RECORDER_PID=$(
    node "$here/../contract/record.mjs" "$WORK/port" "$API_RECORD/$(basename "$0" .sh).record" \
      > "$WORK/recorder" 2> /dev/null &
    echo $!
  )
  for _ in $(seq 1200); do
    [ -s "$WORK/recorder" ] && return
    sleep 0.02
  done
  echo "the recorder did not start"
  exit 1
}

# start_daemon OPTION...: sets DAEMON_PID, PORT and URL. Stand-ins of the solver may write to WORK
# unless CONFINED is set.
start_daemon() {
  [ -n "${CONFINED:-}" ] || set -- --worker-write "$WORK" "$@"
  : > "$WORK/stdout"
  "$BIN/pneulabd" --data "$DATA" --listen 127.0.0.1:0 "$@" > "$WORK/stdout" 2>> "$WORK/stderr" &
  DAEMON_PID=$!
  for _ in $(seq 1200); do
    if grep -q '^listening on https\?://' "$WORK/stdout"; then
      URL=$(sed -n 's/^listening on //p' "$WORK/stdout")
      PORT=${URL##*:}
      echo "$PORT" > "$WORK/port"
      [[ $URL == http://127.0.0.1:* ]] && start_recorder
      if [[ -n $RECORDER_PID && $URL == http://127.0.0.1:* ]]; then
        URL=http://127.0.0.1:$(cat "$WORK/recorder")
      fi
      return 0
    fi
    kill -0 "$DAEMON_PID" 2> /dev/null || break
    sleep 0.05
  done
  echo "the daemon did not start:"; cat "$WORK/stderr"
  exit 1
}

# stop_daemon [SIGNAL]: ends the daemon and leaves its exit status in STATUS.
stop_daemon() {
  kill "-${1:-TERM}" "$DAEMON_PID" 2> /dev/null
  wait "$DAEMON_PID" 2> /dev/null
  STATUS=$?
  DAEMON_PID=
}

cleanup() {
  if [ -n "$DAEMON_PID" ]; then
    kill -KILL "$DAEMON_PID" 2> /dev/null
    wait "$DAEMON_PID" 2> /dev/null
  fi
  if [ -n "$RECORDER_PID" ]; then
    kill "$RECORDER_PID"
  fi
  if [ "$FAILED" -ne 0 ]; then
    echo "the daemon's log:"; tail -200 "$WORK/stderr"
  fi
  rm -rf "$WORK"
}
trap cleanup EXIT

# check WHAT EXPECTED ACTUAL: compares texts.
check() {
  if [ "$2" = "$3" ]; then
    PASSED=$((PASSED + 1))
  else
    FAILED=$((FAILED + 1))
    printf 'FAILED: %s\n  expected: %s\n  actual:   %s\n' "$1" "$2" "$3"
  fi
}

# check_match WHAT PATTERN ACTUAL: an extended regular expression must be found.
check_match() {
  if printf '%s' "$3" | grep -Eq -- "$2"; then
    PASSED=$((PASSED + 1))
  else
    FAILED=$((FAILED + 1))
    printf 'FAILED: %s\n  expected a match of: %s\n  actual: %s\n' "$1" "$2" "$3"
  fi
}

# To be called last.
finish() {
  if [ -n "$DAEMON_PID" ]; then
    check "the daemon is alive at the end" '{"status":"ok"}' "$(curl -s "$URL/healthz" | jq -c .)"
    stop_daemon TERM
    check "the daemon ends with status 0" 0 "$STATUS"
  fi
  check "no sanitizer report" "" "$(grep -E 'ERROR: |WARNING: ThreadSan|runtime error' "$WORK/stderr")"
  echo "$PASSED passed, $FAILED failed"
  [ "$FAILED" -eq 0 ]
  exit
}

# fetch METHOD PATH [CURL OPTION...]: the body into BODY, the status into CODE, headers into HEAD.
fetch() {
  local method=$1 path=$2
  shift 2
  : > "$WORK/body"
  CODE=$(curl -s --path-as-is --max-time 90 -X "$method" -o "$WORK/body" -D "$WORK/head" \
    -w '%{http_code}' "$@" "$URL$path")
  BODY=$(tr -d '\0' < "$WORK/body")
  HEAD=$(tr -d '\r' < "$WORK/head")
}

# header NAME: its value in the last answer.
header() {
  printf '%s\n' "$HEAD" | sed -n "s/^$1: //Ip" | tail -1
}

# field FILTER: a part of the last body.
field() {
  printf '%s' "$BODY" | jq -c -r "$1" 2> /dev/null
}

# submit [DOCUMENT] [CURL OPTION...]: prints the id of a new job.
submit() {
  local document=${1:-$(job)}
  shift
  curl -s -X POST --data-binary "$document" "$@" "$URL/api/v1/jobs" | jq -r .id
}

# wait_state ID PATTERN [SECONDS]: waits until the job's state matches and prints it. A minute is
# for a busy machine.
wait_state() {
  local state='' end=$((SECONDS + ${3:-60}))
  while [ "$SECONDS" -le "$end" ]; do
    state=$(curl -s "$URL/api/v1/jobs/$1" | jq -r .state)
    if printf '%s' "$state" | grep -Eqx -- "$2"; then
      break
    fi
    sleep 0.05
  done
  printf '%s' "$state"
}

# alive PID: whether a process exists and is more than a zombie.
alive() {
  local state
  state=$(sed "s/.*) //; s/ .*//" "/proc/$1/stat" 2> /dev/null)
  if [ -n "$state" ] && [ "$state" != Z ]; then echo yes; else echo no; fi
}

# sql STATEMENT: asks the database file itself.
sql() {
  sqlite3 -cmd '.timeout 5000' "$DATA/pneulab.db" "$1"
}

# job [JQ EDIT]: a valid job, perhaps changed: job '.name = "x"'.
job() {
  jq -c "${1:-.}" <<'END'
{ "kind": "response", "name": "twelve chambers", "labels": { "suite": "api" },
  "actuator": { "family": "pneunet", "length": "118 mm", "width": "30 mm", "height": "15.6 mm",
    "chambers": [ { "config": "B", "count": 12 } ], "chamber_gap": "2 mm", "side_wall": "2 mm",
    "top_wall": "1.5 mm", "bottom_layer": "6 mm", "channel": { "width": "4 mm", "height": "2 mm" } },
  "material": "elastic-50a",
  "load": { "pressure": { "to": "50 kPa", "steps": 2 } },
  "contact": false, "accuracy": "fast", "timeout": "1 min" }
END
}

# light_study NAME SIZE: a document of many members that take some milliseconds each.
light_study() {
  jq -nc --arg name "$1" --argjson size "$2" '{ kind: "study", $name, sampling: "sobol", $size, seed: 7,
    base: { kind: "hlpv", end: "1 s", sample_rate: "5 Hz", initial: { mode: "free" },
      model: { mass: "60 g", gamma: "5.577 N/psi",
        modes: { free: { stiffness: "2000 N/m", damping: "15 N s/m", alpha: "-9 1/s", beta: "9 1/s" } } },
      input: { hold: [["0 s", "3 psi"]] } },
    parameters: [ { pointer: "/model/mass", name: "mass", from: "50 g", to: "70 g" },
      { pointer: "/model/modes/free/damping", from: "10 N s/m", to: "20 N s/m" } ] }'
}

# solver BODY: writes a stand-in for pneulab-solve that runs BODY (with $out, $events, $job set and
# the functions progress and result at hand) and prints its path.
solver() {
  cat > "$WORK/solver" <<END
#!/bin/bash
while [ \$# -gt 1 ]; do
  case \$1 in
    --out) out=\$2; shift 2 ;;
    --events) events=\$2; shift 2 ;;
    --threads | --jobs) shift 2 ;;
    --bundle) bundle=\$2; shift ;;
  esac
done
job=\$1
progress() { echo "{\"event\":\"progress\",\"fraction\":\$1,\"pressure_kPa\":\$2}" >> "\$events"; }
result() {
  echo '{"quads":[],"states":[]}' > "\$out/surface.json"
  cat <<DOC
{"status":"\$1","reason":"\$2","message":"\$3","kind":"response","name":"n",
 "metrics":{"bending_angle_deg":64.25,"mass_g":3.5},
 "samples":[{"pressure_kPa":0,"bending_angle_deg":0},{"pressure_kPa":50,"bending_angle_deg":64.25}],
 "midlines":[],"warnings":[],"artifacts":${artifacts:-[\"surface.json\"]},
 "statistics":{},"provenance":{"version":"0.1.0","spec_hash":"$(printf '%064d' 0)"}}
DOC
}
body() {
  $1
}
if [ -z "\$bundle" ]; then
  body
  exit
fi
member=0
jq -r '.members[]' "\$bundle" | while read -r folder; do
  out=\$folder/out events=\$folder/events.jsonl job=\$folder/job.json
  echo "{\"event\":\"begun\",\"member\":\$member}"
  (body) > "\$folder/result.part"
  code=\$?
  mv "\$folder/result.part" "\$folder/result.json"
  echo "{\"event\":\"done\",\"member\":\$member,\"exit\":\$code,\"cpu_s\":0.5,\"peak_memory_MB\":7}"
  member=\$((member + 1))
done
END
  chmod +x "$WORK/solver"
  printf '%s' "$WORK/solver"
}
