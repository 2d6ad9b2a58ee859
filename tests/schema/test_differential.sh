#!/bin/bash
# The schema checker against ajv: see differential.mjs. Without npm, or when the registry cannot be
# reached, it is skipped.
set -e
source_dir=$(cd "${srcdir:-.}" && pwd)
checker=$PWD/tests/unit/check_lines
command -v npm > /dev/null || exit 77
mkdir -p tests/schema/ajv
cp "$source_dir"/tests/schema/package.json "$source_dir"/tests/schema/package-lock.json \
  tests/schema/ajv/
cd tests/schema/ajv
# Kept from run to run while the lock file stays the same.
if ! cmp -s package-lock.json installed-lock.json; then
  npm ci --silent --no-audit --no-fund --ignore-scripts || exit 77
  cp package-lock.json installed-lock.json
fi
node "$source_dir/tests/schema/differential.mjs" "$source_dir" "$checker" "${DOCUMENTS:-4000}"
