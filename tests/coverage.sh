#!/usr/bin/env bash
# Branch coverage of what reads bytes from outside, in a build of its own in ./coverage, over the
# unit tests, the inputs of the fuzz targets and tests of the API that send what is refused, or over
# the tests that are named, as tests/unit/test_json: tests/coverage.sh [TEST...]
set -euo pipefail
source_dir=$(cd "$(dirname "$0")/.." && pwd)
if [ $# = 0 ]; then
  mapfile -t programs < <(cd "$source_dir" && printf '%s\n' tests/unit/test_*.c tests/fuzz/fuzz_*.c)
  set -- "${programs[@]%.c}"
  for name in cache control errors events hostile http list operation queue security study \
    study_analysis study_designs study_optimise study_plots submit tls; do
    set -- "$@" "tests/api/test_$name.sh"
  done
fi
programs=(pneulabd pneulab-solve pneulab-launch tests/api/raw_client tests/api/hostile_solver)
for name in "$@"; do
  case $name in *.sh) ;; *) programs+=("$name") ;; esac
done
mkdir -p coverage
cd coverage
[ -f Makefile ] || "$source_dir/configure" --quiet CFLAGS='-O0 --coverage' LDFLAGS=--coverage
find . -name '*.gcda' -delete
make -s -j"$(nproc)" WARN_CFLAGS=-w "${programs[@]}" > build.log
export NO_MEMORY_STRIDE=1
make -s WARN_CFLAGS=-w check-TESTS check_PROGRAMS= check_LIBRARIES= API_RECORD= TESTS="$*" \
  > check.log 2>&1 || echo "some tests fail: see coverage/check.log"
python3 "$source_dir/tests/coverage_table.py"
