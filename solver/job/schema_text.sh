#!/bin/sh
# Writes the C source that carries a JSON Schema: schema_text.sh FILE > schema_text.c
set -eu
echo '/* Generated from job.schema.json by schema_text.sh. */'
echo '#include "solver/job/schema.h"'
echo
echo 'static const unsigned char text[] = {'
od -An -v -tu1 "$1" | sed 's/^ */  /; s/  *\([0-9]\)/ \1/g; s/\([0-9]\) /\1, /g; s/$/,/'
echo '  0};'
echo
echo 'const char *job_schema_text(size_t *size) {'
echo '  *size = sizeof text - 1;'
echo '  return (const char *)text;'
echo '}'
