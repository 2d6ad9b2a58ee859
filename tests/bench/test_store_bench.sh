#!/bin/bash
# A trial of bench_store.py: few jobs, some of the lists, no judgement of times.
set -eu
command -v python3 > /dev/null || { echo "SKIP: python3 is not installed"; exit 77; }
out=$(mktemp)
trap 'rm -f "$out"' EXIT
python3 "${srcdir:-.}/tests/bench/bench_store.py" "$out" --jobs 1000 --few 300 --queued 100 --every 13
