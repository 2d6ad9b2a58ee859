#!/bin/bash
# Hybrid models as members of a study: through the daemon, and by the solver alone when it is
# killed, asked to end, or short of time.
. "$(dirname "$0")/lib.sh"
limit=2048
grep -aqE '__(asan|tsan)_init' "$BIN/pneulab-solve" && limit=0
start_daemon --solver "$BIN/pneulab-solve" --memory-limit "$limit" --workers 1

# study [JQ EDIT]: 60 members, all distinct.
study() {
  jq -c "${1:-.}" <<'END'
{ "kind": "study", "name": "masses and dampings", "labels": { "suite": "api" },
  "base": { "kind": "hlpv",
    "model": { "mass": "60 g", "gamma": "5.577 N/psi", "rest_length": "82 mm",
      "modes": {
        "compressed": { "stiffness": { "per": "psi", "coefficients": ["5554.31 N/m", "-700.639 N/m"] },
          "damping": "25 N s/m", "alpha": "-9 1/s", "beta": "9 1/s", "range": ["0 psi", "4 psi"] },
        "stretched": { "rest": "28 mm", "stiffness": "1840 N/m", "damping": "15 N s/m",
          "alpha": "-9 1/s", "beta": "9 1/s" } },
      "transitions": [
        { "from": "compressed", "to": "stretched", "when": { "h": "14.06 mm", "direction": "rising" },
          "reset": { "h": "44.7 mm", "velocity": "0.1067 m/s", "pressure": "5.6 psi" } },
        { "from": "stretched", "to": "compressed", "when": { "h": "27 mm", "direction": "falling" },
          "reset": { "h": "0 mm", "velocity": "0 m/s", "pressure": "0 psi" } } ] },
    "initial": { "mode": "compressed" },
    "input": { "hold": [["0 s", "3 psi"], ["1 s", "6 psi"], ["2 s", "-1 psi"]] },
    "end": "3 s", "sample_rate": "10 Hz", "tolerance": 1e-9, "timeout": "1 min" },
  "sampling": "grid",
  "parameters": [
    { "pointer": "/model/mass", "name": "mass",
      "values": ["50 g", "55 g", "60 g", "65 g", "70 g", "75 g"] },
    { "pointer": "/model/modes/stretched/damping", "name": "damping",
      "values": ["10 N s/m", "11 N s/m", "12 N s/m", "13 N s/m", "14 N s/m", "15 N s/m",
        "16 N s/m", "17 N s/m", "18 N s/m", "19 N s/m"] } ],
  "timeout": "20 min" }
END
}

fetch POST /api/v1/jobs:validate --data-binary "$(study)"
check "it is valid" true "$(field .valid)"
fetch POST /api/v1/jobs -H 'Prefer: wait=60' --data-binary "$(study)"
id=$(field .id)
check "it succeeds" succeeded "$(wait_state "$id" 'succeeded|failed|timed_out' 300)"
fetch GET "/api/v1/jobs/$id/result"
check "every member is solved" "60 60 60" "$(field '.metrics | "\(.designs) \(.solved) \(.distinct)"')"
check "without samples" 0 "$(field '[.members[].samples[]] | length')"
check "each snaps and returns" "[2]" "$(field '[.members[].metrics.event_count] | unique')"
check "it says how many have warnings" "60 of 60" "$(field '.warnings[0]' | cut -c 1-8)"
check "the extremes are those of the members" "$(field '[.members[].metrics.peak_speed_m_s] | "\(min) \(max)"')" \
  "$(field '.summary.peak_speed_m_s | "\(.lowest) \(.highest)"')"
check "and belong to them" \
  "$(field '.summary.peak_speed_m_s as $s | .members[$s.highest_member].metrics.peak_speed_m_s')" \
  "$(field '.summary.peak_speed_m_s.highest')"
check "the mean is that of the members" true "$(field '([.members[].metrics.settling_time_s] | add / length) as $m
  | (.summary.settling_time_s.mean - $m) / $m | fabs < 1e-9')"
check "a row of the database a member" 60 \
  "$(sql "select count(*) from sample where job_id = $id and name = 'settling_time_s'")"

# A member is what its job alone comes to.
study '.base | .model.mass = "65 g" | .model.modes.stretched.damping = "17 N s/m"' > "$WORK/alone.json"
"$BIN/pneulab-solve" "$WORK/alone.json" > "$WORK/alone.out"
check "a member is the job that it is" "$(jq -c .metrics "$WORK/alone.out")" \
  "$(field '.members[37].metrics' | jq -c .)"
check "with its hash" "$(jq -r .provenance.spec_hash "$WORK/alone.out")" "$(field '.members[37].spec_hash')"
fetch GET "/api/v1/jobs/$id/plots/metric.png?metric=extension_ratio"
check "a plot of a metric of choice" "200 image/png" "$CODE $(header Content-Type)"
fetch GET "/api/v1/jobs/$id/plots/metric.png"
check "its plot is there" 200 "$CODE"

fetch POST /api/v1/jobs --data-binary "$(study '.parameters[0].values[1] = "-55 g"')"
check "a negative mass is refused" "422 /parameters/0/values/1" "$CODE $(field .pointer)"

# Samples, when asked for.
study '.keep = "samples"' > "$WORK/samples.json"
"$BIN/pneulab-solve" "$WORK/samples.json" > "$WORK/samples.out"
check "samples and switches are kept" "31 2" \
  "$(jq -r '.members[59] | "\(.samples | length) \(.events | length)"' "$WORK/samples.out")"

# wavy END [JQ EDIT]: members that take some time, since their set-point never rests.
wavy() {
  study ".base.input = { sine: { amplitude: \"1 psi\", frequency: \"5 Hz\" } } | .base.end = \"$1\"
    | .base.tolerance = 1e-12 | .base.sample_rate = \"0.01 Hz\" | ${2:-.}"
}

# lines FILE COUNT: waits until a file has so many lines.
lines() {
  for _ in $(seq 1500); do
    [ -s "$1" ] && [ "$(wc -l < "$1")" -ge "$2" ] && return
    sleep 0.02
  done
}
# workers PID: waits for processes that solve members, and prints their ids.
workers() {
  for _ in $(seq 1500); do
    pgrep -P "$1" && return
    sleep 0.02
  done
}

# Killed and resumed.
wavy '15 s' > "$WORK/long.json"
"$BIN/pneulab-solve" --out "$WORK/out" --jobs 2 --events "$WORK/events" "$WORK/long.json" > "$WORK/killed.out" &
solver=$!
lines "$WORK/events" 5
left=$(workers "$solver")
kill -KILL "$solver"
wait "$solver" 2> /dev/null
for worker in $left; do
  for _ in $(seq 250); do
    [ "$(alive "$worker")" = no ] && break
    sleep 0.02
  done
  check "its processes end with it" no "$(alive "$worker")"
done
"$BIN/pneulab-solve" --out "$WORK/out" "$WORK/long.json" > "$WORK/resumed.out"
check_match "what was there is not solved again" '^60 ([5-9]|[1-5][0-9]|60)$' \
  "$(jq -r '.metrics | "\(.solved) \(.resumed)"' "$WORK/resumed.out")"
"$BIN/pneulab-solve" "$WORK/long.json" > "$WORK/whole.out"
check "the result is as without the kill" "$(jq -c '[.members[].metrics]' "$WORK/whole.out" | md5sum)" \
  "$(jq -c '[.members[].metrics]' "$WORK/resumed.out" | md5sum)"

# Asked to end.
wavy '2e5 s' > "$WORK/endless.json"
"$BIN/pneulab-solve" "$WORK/endless.json" > "$WORK/cancelled.out" &
solver=$!
workers "$solver" > /dev/null
kill -TERM "$solver"
wait "$solver"
check "cancelled" 5 "$?"
check "its members were not run" "cancelled not_run" \
  "$(jq -r '"\(.reason) \(.members[59].reason)"' "$WORK/cancelled.out")"

# A member has its own time limit.
wavy '1 s' '.base.timeout = "1 s" | .parameters = [ { pointer: "/end", values: ["1 s", "2e5 s", "2 s"] } ]' \
  > "$WORK/limit.json"
"$BIN/pneulab-solve" "$WORK/limit.json" > "$WORK/limit.out"
check "the study succeeds" 0 "$?"
check "without the member that ran out of time" "succeeded:,diverged:timeout,succeeded:" \
  "$(jq -r '[.members[] | "\(.status):\(.reason)"] | join(",")' "$WORK/limit.out")"

# A process that is killed takes one member with it, not the others.
"$BIN/pneulab-solve" --jobs 1 --events "$WORK/events2" "$WORK/long.json" > "$WORK/crash.out" &
solver=$!
lines "$WORK/events2" 3
pkill -KILL -P "$solver"
wait "$solver"
check "the study goes on" 0 "$?"
check "with one member crashed" "59 crashed" \
  "$(jq -r '"\(.metrics.solved) \([.members[] | select(.status == "failed") | .reason] | join(","))"' "$WORK/crash.out")"
finish
