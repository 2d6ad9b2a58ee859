#!/bin/sh
# Installs the packages of static/package-lock.json in static/node_modules of the build directory, once:
# install.sh SOURCE_DIR
set -eu
source_dir=$1
for tool in node npm; do
  command -v $tool > /dev/null || {
    echo "install.sh: $tool is needed to bundle the libraries of the pages (Debian: nodejs npm)" >&2
    echo "install.sh: a released tarball carries them" >&2
    exit 1
  }
done
mkdir -p static
cd static
for file in package.json package-lock.json; do
  cmp -s "$source_dir/$file" "$file" || cp "$source_dir/$file" .
done
if ! cmp -s package-lock.json node_modules/.installed; then
  if ! npm ci --ignore-scripts --no-audit --no-fund --prefer-offline --fetch-retries=2 \
    --fetch-timeout=60000 > npm.log 2>&1; then
    cat npm.log >&2
    echo "install.sh: npm cannot install the packages of static/package-lock.json" >&2
    exit 1
  fi
  cp package-lock.json node_modules/.installed
fi
