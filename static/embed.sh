#!/bin/sh
# Writes the C table of the pages to standard output: embed.sh SOURCE_DIR FILE...
# Each FILE is relative to SOURCE_DIR, or to static/ here when it is made. Pages get the path /FILE, everything else /static/FILE.
set -eu
source_dir=$1
shift

place() {
  if [ -f "$source_dir/$1" ]; then echo "$source_dir/$1"; else echo "static/$1"; fi
}

content_type() {
  case $1 in
    *.html) echo 'text/html; charset=utf-8' ;;
    *.css) echo 'text/css; charset=utf-8' ;;
    *.js) echo 'text/javascript; charset=utf-8' ;;
    *.svg) echo 'image/svg+xml' ;;
    *) echo "embed.sh: no content type for $1" >&2; exit 1 ;;
  esac
}

url_path() {
  case $1 in
    *.html) echo "/$1" ;;
    *) echo "/static/$1" ;;
  esac
}

echo '/* Generated from static/ by static/embed.sh. */'
echo '#include "server/http/static_files.h"'
number=0
for file in "$@"; do
  echo "static const unsigned char data_${number}[] = {"
  od -An -v -tx1 "$(place "$file")" | sed 's/ *\([0-9a-f][0-9a-f]\)/0x\1,/g'
  echo '};'
  number=$((number + 1))
done
echo 'const struct static_file static_files[] = {'
number=0
for file in "$@"; do
  type=$(content_type "$file")
  etag=$(cksum < "$(place "$file")" | awk '{ printf "%08x-%x", $1, $2 }')
  printf '    {"%s", "%s", data_%d, sizeof data_%d, "\\"%s\\""},\n' \
    "$(url_path "$file")" "$type" "$number" "$number" "$etag"
  number=$((number + 1))
done
echo '};'
echo 'const size_t static_file_count = sizeof static_files / sizeof *static_files;'
