#!/bin/bash
# Runs a test of the pages: run.sh TEST.mjs, from the build directory. What follows is the script's.
CALLED_FROM=$PWD
CHROMIUM=${CHROMIUM:-$(command -v chromium || command -v chromium-browser)}
if [ -z "$CHROMIUM" ]; then
  echo "skipped: Chromium is not installed (Debian: apt-get install chromium)"
  exit 77
fi
BIN=${BIN:-$PWD}
export CHROMIUM BIN CALLED_FROM
# shellcheck source-path=SCRIPTDIR
. "$(dirname "$0")/../npm.sh"
script=$(basename "$1")
shift
exec timeout 600 node "$script" "$@"
