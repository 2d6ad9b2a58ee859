#!/usr/bin/env bash
# Runs a fuzz target for some minutes of CPU time on its corpus, and says what it did:
#   tests/fuzz/run.sh [--minutes N] [--work DIR] TARGET...
# In a build directory made with: configure CC=clang --enable-fuzzers --enable-sanitizers
# New inputs are kept in DIR/TARGET, findings in DIR/TARGET-findings. `--minimise` instead writes
# the smallest set of inputs that reaches the same into DIR/TARGET-small.
set -euo pipefail

minutes=30
work=fuzz-work
minimise=false
targets=()
while [ $# -gt 0 ]; do
  case $1 in
  --minutes) minutes=$2 && shift ;;
  --work) work=$2 && shift ;;
  --minimise) minimise=true ;;
  *) targets+=("$1") ;;
  esac
  shift
done
[ "${#targets[@]}" -gt 0 ] || targets=(job csv units stl url http)
source_dir=$(cd "$(dirname "$0")" && pwd)
export ASAN_OPTIONS=detect_leaks=1:allocator_may_return_null=1
export UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1
export LSAN_OPTIONS=suppressions=$source_dir/../lsan.supp:print_suppressions=0
TIMEFORMAT='%U %S'

# run_target NAME: pieces of a minute each until the CPU time is used up; fails on a finding.
run_target() {
  local name=$1 program=tests/fuzz/fuzz_$1 corpus=$source_dir/corpus/$1
  local found=$work/$1-findings log=$work/$1.log used=0 runs=0 spent count options=()
  mkdir -p "$work/$name" "$found"
  [ ! -f "$source_dir/$name.dict" ] || options+=("-dict=$source_dir/$name.dict")
  if $minimise; then
    mkdir -p "$work/$name-small"
    "$program" -merge=1 "$work/$name-small" "$corpus" "$work/$name" >"$log" 2>&1
    echo "$name: $(find "$work/$name-small" -type f | wc -l) inputs are enough"
    return 0
  fi
  while awk "BEGIN { exit !($used < 60 * $minutes) }"; do
    local status=0
    spent=$( { time "$program" "${options[@]}" -max_total_time=60 -timeout=25 -rss_limit_mb=2048 \
      -print_final_stats=1 -max_len=8192 -artifact_prefix="$found/" "$work/$name" "$corpus" \
      >"$log" 2>&1; } 2>&1) || status=$?
    used=$(awk "BEGIN { split(\"$spent\", part, \" \"); print $used + part[1] + part[2] }")
    count=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log" | tail -n 1)
    runs=$((runs + ${count:-0}))
    if [ "$status" -ne 0 ]; then
      echo "$name: FINDING after $runs executions, $used s of CPU time: see $log, $found"
      return 1
    fi
  done
  echo "$name: no finding in $runs executions, $used s of CPU time," \
    "$(grep -o 'cov: [0-9]*' "$log" | tail -n 1) edges," \
    "$(find "$work/$name" -type f | wc -l) new inputs"
}

failed=0
for target in "${targets[@]}"; do
  run_target "$target" || failed=1
done
exit "$failed"
