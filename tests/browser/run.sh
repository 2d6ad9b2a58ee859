#!/bin/bash
# Runs a test of the pages: run.sh TEST.mjs, from the build directory.
CHROMIUM=${CHROMIUM:-$(command -v chromium || command -v chromium-browser)}
if [ -z "$CHROMIUM" ]; then
  echo "skipped: Chromium is not installed (Debian: apt-get install chromium)"
  exit 77
fi
BIN=${BIN:-$PWD}
export CHROMIUM BIN
# shellcheck source-path=SCRIPTDIR
. "$(dirname "$0")/../npm.sh"
exec timeout 600 node "$(basename "$1")"
