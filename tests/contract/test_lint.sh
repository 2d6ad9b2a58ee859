#!/bin/bash
# The description of the API and its examples, by Redocly and Spectral.
description=$PWD/schema/bundle/openapi.yaml
# shellcheck source-path=SCRIPTDIR
. "$(dirname "$0")/../npm.sh"
exec timeout 120 node lint.mjs "$description"
