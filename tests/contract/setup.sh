# shellcheck shell=bash
# Shared by the tests of the API's description: their scripts and the packages of package-lock.json in
# tests/contract of the build directory. Source it; it leaves the shell there.
set -u
source_dir=$(cd "$(dirname "$0")" && pwd)
for tool in node npm; do
  command -v $tool > /dev/null || { echo "skipped: $tool is not installed"; exit 77; }
done
mkdir -p tests/contract
cd tests/contract || exit 1
for file in "$source_dir"/*.mjs "$source_dir"/package*.json; do
  cmp -s "$file" "$(basename "$file")" || cp "$file" . || exit 1
done
if ! cmp -s package-lock.json node_modules/.installed; then
  if ! timeout 300 npm ci --ignore-scripts --no-audit --no-fund --prefer-offline \
    --fetch-retries=2 --fetch-timeout=30000 > npm.log 2>&1; then
    cat npm.log
    echo "FAILED: npm cannot install the packages of tests/contract/package-lock.json"
    exit 1
  fi
  cp package-lock.json node_modules/.installed
fi
