#!/bin/sh
# From figures to the document: what is met, short or missing is said so, and ratios to CalculiX
# are taken at equal accuracy.
set -eu
build=$(pwd)
source=$(cd "${srcdir:-.}" && pwd)
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
fail() {
  echo "FAILED: $1"
  exit 1
}
contains() {
  grep -qF "$1" "$dir/out.md" || fail "no line: $1"
}
mkdir "$dir/in" "$dir/figures"
write() {
  "$build/tools/performance" "$source/docs/PERFORMANCE.in.md" "$dir/out.md" "$dir/figures" "$dir/in"
}

# Without figures the document says what to run.
write
contains '(nothing measured yet)'
contains 'Not measured: run `make bench`.'
contains 'Not measured: run `make bench-robustness`.'
[ "$(grep -c '| not measured |' "$dir/out.md")" = 14 ] || fail "targets without figures"
! grep -q '@[A-Z]*@' "$dir/out.md" || fail "a marker is left"

# A processor, a fast cold solve, and neighbours of which one is slow.
cat >"$dir/in/warm.json" <<'JSON'
{ "machine": { "processor": "Test 9000", "cores": 4, "blas": "B", "blas_kernels": "K", "dgemm_flop_s": 5e10 },
  "cold": { "path_s": 1.5, "estimate_s": 0.5, "process_s": 2.1, "factorizations": 31, "peak_memory_bytes": 1e8 },
  "neighbours": [
    { "dimension": "height", "change": 0.02, "warm_start": true, "warm_s": 0.5, "cold_s": 1, "warm_factorizations": 8,
      "cold_factorizations": 20, "angle_difference": 1e-6 },
    { "dimension": "height", "change": 0.1, "warm_start": false, "warm_s": 0.9, "cold_s": 0.9, "warm_factorizations": 20,
      "cold_factorizations": 20, "angle_difference": 0 } ] }
JSON
# Five designs: the end, a limit of the body, the solver's own failure, a hang, a crash.
cat >"$dir/in/robustness.json" <<'JSON'
{ "options": { "accuracy": "standard", "jobs": 2, "limit_s": 120 },
  "summary": { "designs_per_hour": 5000, "touched": 1, "reasons": { "limit_point": 1 } },
  "designs": [
    { "index": 0, "status": "succeeded", "reason": "", "cpu_s": 1, "peak_memory_MB": 100 },
    { "index": 1, "status": "diverged", "reason": "limit_point", "cpu_s": 2, "peak_memory_MB": 600 },
    { "index": 2, "status": "diverged", "reason": "contact_cycling", "cpu_s": 3, "peak_memory_MB": 100,
      "job": { "material": "soft", "actuator": { "chambers": [ { "config": "B", "count": 2 }, { "config": "C", "count": 3 } ] } } },
    { "index": 3, "status": "timed_out", "reason": "time_limit", "cpu_s": 120, "peak_memory_MB": 100 },
    { "index": 4, "status": "crashed", "reason": "signal_11", "cpu_s": 1, "peak_memory_MB": 100 } ] }
JSON
# CalculiX: dearer than `standard` by 20 on the same mesh, by 100 on the mesh that is as accurate.
cat >"$dir/in/calculix.json" <<'JSON'
{ "bodies": [ { "chambers": 3, "reference_deg": 4, "reference_unknowns": 1000, "meshes": [
  { "name": "standard", "unknowns": 10, "ours": { "cpu_s": 1, "angle_deg": 4, "error": 0.01 },
    "calculix": { "cpu_s": 20, "increments": 10, "angle_deg": 4, "error": 0.08 } },
  { "name": "fine", "unknowns": 20, "ours": { "cpu_s": 3, "angle_deg": 4, "error": 0.002 },
    "calculix": { "cpu_s": 100, "increments": 10, "angle_deg": 4, "error": 0.01 } } ] } ] }
JSON
cat >"$dir/in/scaling.json" <<'JSON'
{ "series": [ { "name": "refinement", "points": [
  { "unknowns": 1000, "chambers": 1, "step_s": 0.01 }, { "unknowns": 10000, "chambers": 1, "step_s": 0.1 },
  { "unknowns": 100000, "chambers": 1, "step_s": 1.0 } ] } ] }
JSON
cat >"$dir/in/hybrid.json" <<'JSON'
{ "simulation": { "with_samples_s": 0.004, "without_samples_s": 0.003, "samples": 4801, "steps": 2700, "evaluations": 3800,
    "state_error": 1e-9, "event_error_s": 1e-11 },
  "octave": { "version": "7.3.0", "time_s": 1, "ratio": 250, "state_error": 1e-8, "event_error_s": 1e-5 } }
JSON
cat >"$dir/in/queue.json" <<'JSON'
{ "members": 10000, "solved": 10000, "post_s": 1, "wall_s": 50, "cpu_s": 30, "daemon_cpu_s": 10, "simulations_per_minute_wall": 11765,
  "simulations_per_minute_core": 15000, "solver_peak_memory_MB": 70, "daemon_peak_memory_MB": 200, "result_bytes": 1e7,
  "page_s": 0.3, "result_s": 0.1, "plot_s": 0.5 }
JSON
write
contains '| processor | Test 9000 |'
contains '| designs that reach the end or a named physical limit | all | 2 of 5 (40.0 %) | **short** |'
contains '| designs that hang, that crash | none | 1, 1 | **short** |'
contains '| at most 2.00 s | 1.50 s | met |'
contains '| its factorisations | at most 30 | 31 | **short** |'
contains '| at most 0.80 s | 0.90 s | **short** |'
contains '| at most 500 MB | 600 MB | **short** |'
contains '| at least 50 times | 100 times (errors 1.0 and 1.0 %) | met |'
contains '| 20 | 100 (fine, 1.00 %) |'
contains '| 33 | more than 33 (fine, 1.00 %) |'
contains '| 2 | 2 B + 3 C | soft | diverged | `contact_cycling` |'
! grep -q '^| 1 | .*limit_point' "$dir/out.md" || fail "a limit of the body is among the rest"
contains '| at most 5.00 ms | 4.00 ms | met |'
contains '| at least 300 times | 250 times | **short** |'
contains '| at least 10000 | 15000 | met |'
contains '| its time over ours with samples | **250** |'
contains '| 10000 of 10000 |'
contains '| CPU time of the solvers, of the daemon | 30.0, 10.0 s |'
contains '| one step | 1.00 | 1000 to 100000 | 3 |'
for figure in performance-unknowns performance-designs; do
  contains "(figures/$figure.png)"
  [ "$(head -c 8 "$dir/figures/$figure.png" | od -An -tx1 | tr -d ' \n')" = 89504e470d0a1a0a ] ||
    fail "$figure is no PNG"
  [ "$(wc -c <"$dir/figures/$figure.png")" -lt 60000 ] || fail "$figure is too large"
done

# Damaged figures end it with their name.
echo '{' >"$dir/in/solve.json"
if write 2>"$dir/err"; then fail "a damaged file is taken"; fi
grep -q 'solve.json' "$dir/err" || fail "the damaged file's name"
echo "document of figures: good"
