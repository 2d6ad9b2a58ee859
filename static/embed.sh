#!/bin/sh
# Writes the C table of the pages to standard output: embed.sh SOURCE_DIR FILE...
#
# Each FILE is made below static/ here, or else it is of SOURCE_DIR. Pages get the path /FILE (those in
# pages/, which the daemon fills in, just FILE, which no request has), everything else /static/FILE. The
# bytes are taken in by the assembler, since a compiler needs long for a table of a megabyte. Texts are
# there a second time packed by gzip, and a third time when FILE.br exists.
#
# A library, vendor/NAME.js, is large and rarely changes: it is served as vendor/NAME-HASH.js, which may be
# kept for ever, and vendor/NAME.js is a module of one line that hands on what that one exports.
set -eu
source_dir=$1
shift
packed=static/packed
rm -rf "$packed"
mkdir -p "$packed"

place() {
  if [ -f "static/$1" ]; then echo "static/$1"; else echo "$source_dir/$1"; fi
}

content_type() {
  case $1 in
    *.html) echo 'text/html; charset=utf-8' ;;
    *.css) echo 'text/css; charset=utf-8' ;;
    *.js) echo 'text/javascript; charset=utf-8' ;;
    *.svg) echo 'image/svg+xml' ;;
    *.txt) echo 'text/plain; charset=utf-8' ;;
    *) echo "embed.sh: no content type for $1" >&2; exit 1 ;;
  esac
}

url_path() {
  case $1 in
    pages/*) echo "$1" ;;
    *.html) echo "/$1" ;;
    *) echo "/static/$1" ;;
  esac
}

hash_of() {
  sha256sum < "$1" | cut -c 1-16
}

count=0
table=
# data FILE: the bytes of a file under the name data_COUNT; prints nothing when there is no file.
data() {
  printf '__asm__(".section .rodata\\n"\n        "data_%d: .incbin \\"%s\\"\\n"\n        ".previous");\n' \
    "$count" "$1"
  printf 'extern const unsigned char data_%d[];\n' "$count"
}

# content FILE: sets `content` to the C value of its bytes.
content() {
  content='{NULL, 0}'
  if [ -f "$1" ]; then
    data "$1"
    content="{data_$count, $(wc -c < "$1")}"
    count=$((count + 1))
  fi
}

# entry PATH NAME FILE FOREVER: a row of the table, and the bytes that it needs.
entry() {
  zipped=$packed/$count.gz
  gzip -9n < "$3" > "$zipped"
  content "$3"
  plain=$content
  content "$zipped"
  gzip=$content
  content "$3.br"
  table="$table    {\"$1\", \"$(content_type "$2")\", \"$(hash_of "$3")\", $4, $plain, $gzip, $content},
"
}

echo '/* Generated from static/ by static/embed.sh. */'
echo '#include "server/http/static_files.h"'
for file in "$@"; do
  from=$(place "$file")
  case $file in
    vendor/*.js)
      hashed=${file%.js}-$(hash_of "$from").js
      entry "/static/$hashed" "$file" "$from" true
      stub=$packed/$(basename "$file")
      echo "export * from '/static/$hashed';" > "$stub"
      entry "/static/$file" "$file" "$stub" false
      ;;
    *) entry "$(url_path "$file")" "$file" "$from" false ;;
  esac
done
echo 'const struct static_file static_files[] = {'
printf '%s' "$table"
echo '};'
echo 'const size_t static_file_count = sizeof static_files / sizeof *static_files;'
