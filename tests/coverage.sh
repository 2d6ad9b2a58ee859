#!/usr/bin/env bash
# Branch coverage of what reads bytes from outside, over the tests of `make check` (or those that are
# named, as tests/unit/test_json), in a build of its own in ./coverage: tests/coverage.sh [TEST...]
set -euo pipefail
source_dir=$(cd "$(dirname "$0")/.." && pwd)
mkdir -p coverage
cd coverage
[ -f Makefile ] || "$source_dir/configure" --quiet CFLAGS='-O0 --coverage' LDFLAGS=--coverage
find . -name '*.gcda' -delete
make -s -j"$(nproc)" WARN_CFLAGS=-w check TESTS= > build.log
make -s WARN_CFLAGS=-w check ${1:+TESTS="$*"} > check.log 2>&1 ||
  echo "some tests fail: see coverage/check.log"
python3 "$source_dir/tests/coverage_table.py"
