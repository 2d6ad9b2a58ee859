#!/bin/bash
# What the tests of the API sent and got, compared with its description. They leave their records in
# API_RECORD; so they run before this.
description=$PWD/schema/bundle/openapi.json
# shellcheck source-path=SCRIPTDIR
. "$(dirname "$0")/../npm.sh"
if ! ls "$API_RECORD"/*.record > /dev/null 2>&1; then
  echo "FAILED: there are no records in ${API_RECORD:-API_RECORD}"
  exit 1
fi
exec timeout 120 node drift.mjs "$description" "$API_RECORD"/*.record
