#!/bin/bash
# Studies that search: a hybrid model without derivatives, a bending profile by derivatives; through
# the daemon, which is killed meanwhile, and by the solver alone, which goes on where it was.
. "$(dirname "$0")/lib.sh"
limit=2048
grep -aqE '__(asan|tsan)_init' "$BIN/pneulab-solve" && limit=0

# The stiffness at which 3 psi stretch a spring by 6 mm: 5.577 N/psi x 3 psi / 6 mm = 2788.5 N/m.
spring() {
  jq -nc '{ kind: "study", name: "spring", sampling: "optimise", tolerance: 1e-4,
    objective: { target: { max_h_mm: 6 } },
    base: { kind: "hlpv", end: "3 s", sample_rate: "5 Hz", initial: { mode: "free" },
      model: { mass: "60 g", gamma: "5.577 N/psi",
        modes: { free: { stiffness: "2000 N/m", damping: "15 N s/m", alpha: "-9 1/s", beta: "9 1/s" } } },
      input: { hold: [["0 s", "3 psi"]] } },
    parameters: [ { pointer: "/model/modes/free/stiffness", name: "stiffness", from: "1000 N/m",
      to: "6000 N/m", scale: "log" } ] }'
}

# A body of three chambers. The profile is that of the walls named here.
known='.actuator.gap_wall = "1.7 mm" | .actuator.bottom_layer = "3.4 mm"'
body() {
  jq -c "${1:-.}" <<'END'
{ "kind": "response",
  "actuator": { "family": "pneunet", "length": "40 mm", "width": "20 mm", "height": "15 mm",
    "chambers": [{ "config": "B", "count": 3 }], "chamber_gap": "2 mm", "side_wall": "2 mm",
    "gap_wall": "2 mm", "top_wall": "2 mm", "bottom_layer": "4 mm" },
  "material": "dragon-skin-20", "load": { "pressure": { "to": "30 kPa", "steps": 2 } },
  "error_estimate": false,
  "mesh": { "gap_wall": 1, "cavity": 1, "gap": 1, "half_width": 1, "side_wall": 1, "bottom": 1,
    "height": 1, "top": 1 } }
END
}

body "$known" > "$WORK/known.json"
"$BIN/pneulab-solve" "$WORK/known.json" > "$WORK/known.out"

# profile [JQ EDIT]
profile() {
  jq -c --argjson base "$(body)" '{ kind: "study", name: "profile", sampling: "optimise",
    base: $base, objective: { profile: .midlines[-1].points_mm }, budget: 20, tolerance: 1e-4,
    parameters: [ { pointer: "/actuator/gap_wall", from: "1.2 mm", to: "3 mm", start: "2.6 mm" },
      { pointer: "/actuator/bottom_layer", from: "3 mm", to: "5 mm", start: "4.8 mm" } ] } |
    '"${1:-.}" "$WORK/known.out"
}

# ---- in the daemon

start_daemon --solver "$BIN/pneulab-solve" --memory-limit "$limit" --workers 2
id=$(submit "$(spring)")
check "a search without derivatives ends" succeeded "$(wait_state "$id" 'succeeded|failed|timed_out' 120)"
fetch GET "/api/v1/jobs/$id/result"
check "it finds the stiffness" true "$(field '.optimum.values["/model/modes/free/stiffness"]
  | rtrimstr(" N/m") | tonumber / 2788.5 - 1 | fabs < 1e-3')"
check "its members are jobs" "$(field '.metrics.designs')" \
  "$(sql "select count(*) from job where study_id = $id and state = 'succeeded'")"
check "with their parameter" "$(field '.metrics.designs')" \
  "$(sql "select count(*) from study_value where study_id = $id and number between 1000 and 6000")"
check "the history has them all" "$(field '.metrics.designs')" "$(field '.history | length')"
check "the best of it only gets better" true "$(field '[.history[].best] | . == (sort | reverse)')"

id=$(submit "$(profile '.starts = 2 | .budget = 30')")
for round in 1 2; do
  for _ in $(seq 600); do
    ended=$(sql "select count(*) from job where study_id = $id and finished_ms is not null")
    [ "$ended" -ge $((round * 3)) ] && break
    sleep 0.02
  done
  stop_daemon KILL
  start_daemon --solver "$BIN/pneulab-solve" --memory-limit "$limit" --workers 2
done
check "a search goes on after the daemon was killed" succeeded \
  "$(wait_state "$id" 'succeeded|failed|timed_out' 300)"
fetch GET "/api/v1/jobs/$id/result"
check "it reaches the profile" true "$(field '.optimum.max_distance_mm < 0.01 * .optimum.profile_length_mm
  and .optimum.value < 0.001 * .optimum.profile_length_mm')"
check "by the walls behind it" true "$(field '.optimum.values | (.["/actuator/gap_wall"]
  | rtrimstr(" mm") | tonumber - 1.7 | fabs < 0.01) and (.["/actuator/bottom_layer"]
  | rtrimstr(" mm") | tonumber - 3.4 | fabs < 0.02)')"
check "from both starts" "2" "$(field '[.starts[].ending | select(. == "reached" or . == "converged")] | length')"
check "members are there once" 0 \
  "$(sql "select count(*) - count(distinct member) from job where study_id = $id")"

id=$(submit "$(profile '.tolerance = 1e-9 | .starts = 8 | .budget = 200')")
for _ in $(seq 600); do
  [ "$(sql "select count(*) from job where study_id = $id and finished_ms is not null")" -gt 2 ] && break
  sleep 0.02
done
fetch POST "/api/v1/jobs/$id/cancel"
check "a search is cancelled" cancelled "$(wait_state "$id" 'succeeded|failed|cancelled' 60)"
check "with its members" 0 "$(sql "select count(*) from job where finished_ms is null")"
fetch POST /api/v1/jobs --data-binary "$(profile 'del(.objective)')"
check "without an objective there is none" "422 true" "$CODE $(field '.detail | test("objective")')"

# ---- by the solver alone

profile > "$WORK/profile.json"
"$BIN/pneulab-solve" --out "$WORK/out" --jobs 2 "$WORK/profile.json" > "$WORK/whole.out"
solves=$(jq '.metrics.designs' "$WORK/whole.out")
check "few solves do" true "$(jq '.metrics.designs <= 12 and .optimum.within_limits' "$WORK/whole.out")"
last=$(jq -r '.members[-1].spec_hash' "$WORK/whole.out")
rm "$WORK/out/members/$last.json"
"$BIN/pneulab-solve" --out "$WORK/out" --jobs 2 "$WORK/profile.json" > "$WORK/again.out"
check "what was solved is not solved again" "1 $((solves - 1))" \
  "$(jq -r '.metrics | "\(.computed) \(.resumed)"' "$WORK/again.out")"
check "the search is the same" "$(jq -c '[.optimum, .history]' "$WORK/whole.out")" \
  "$(jq -c '[.optimum, .history]' "$WORK/again.out")"
"$BIN/pneulab-solve" --out "$WORK/killed" --jobs 1 "$WORK/profile.json" > /dev/null &
solver_pid=$!
for _ in $(seq 600); do
  [ "$(find "$WORK/killed/members" -name '*.json' ! -name '*.job.json' 2>/dev/null | wc -l)" -ge 2 ] && break
  sleep 0.02
done
kill -KILL "$solver_pid"
wait "$solver_pid" 2>/dev/null || true
"$BIN/pneulab-solve" --out "$WORK/killed" --jobs 1 "$WORK/profile.json" > "$WORK/killed.out"
check "after a kill it goes on, to the same end" "$(jq -c '.optimum' "$WORK/whole.out")" \
  "$(jq -c '.optimum' "$WORK/killed.out")"
check "with what it had" true "$(jq '.metrics.resumed >= 2' "$WORK/killed.out")"
finish
