#!/bin/sh
# Bundles of jobs: the same answers as runs of their own, the same bytes every time.
set -eu
command -v python3 >/dev/null || exit 77
solve=$(pwd)/pneulab-solve
source=$(cd "${srcdir:-.}" && pwd)
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"
python3 "$source/tests/physics/check_bundle.py" "$solve"

# A file that lists no folders, or is none.
for text in '{ "members": [] }' '{ "members": [1] }' '{' '{ "folders": ["a"] }'; do
  echo "$text" >wrong.json
  status=0
  "$solve" --bundle wrong.json >out.txt 2>log.txt || status=$?
  if [ "$status" != 4 ] || [ -s out.txt ] || ! grep -q pneulab-solve: log.txt; then
    echo "$text: exit status $status"
    exit 1
  fi
done
