# shellcheck shell=bash
# Shared by the tests that run on Node.js: the scripts of their folder and the packages of its
# package-lock.json, in the folder of the same name in the build directory. Source it; it leaves the
# shell there. Tests run side by side: the first one installs, the others wait.
set -u
source_dir=$(cd "$(dirname "$0")" && pwd)
for tool in node npm flock; do
  command -v $tool > /dev/null || { echo "skipped: $tool is not installed"; exit 77; }
done
folder=tests/$(basename "$source_dir")
mkdir -p "$folder"
cd "$folder" || exit 1
install_packages() {
  local file
  for file in "$source_dir"/*.mjs "$source_dir"/package*.json; do
    cmp -s "$file" "$(basename "$file")" || cp "$file" . || return 1
  done
  cmp -s package-lock.json node_modules/.installed && return 0
  if ! timeout 300 npm ci --ignore-scripts --no-audit --no-fund --prefer-offline \
    --fetch-retries=2 --fetch-timeout=30000 > npm.log 2>&1; then
    cat npm.log
    echo "FAILED: npm cannot install the packages of $folder/package-lock.json"
    return 1
  fi
  cp package-lock.json node_modules/.installed
}
{ flock 9 && install_packages; } 9> .lock || exit 1
