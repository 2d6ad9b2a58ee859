#!/bin/sh
# Includes only point downwards: base < job, explore, rigid < mesh < fe, hlpv, axi < post, verify, material, identify, snap, bistable < run,
# grasp, study within the solver; the server uses of the solver only base, job and explore; the solver never sees the server.
set -u
cd "$(dirname "$0")/../.." || exit 1
rank() {
  case $1 in
  solver/base/*) echo 1 ;;
  solver/job/*) echo 2 ;;
  solver/explore/*) echo 2 ;;
  solver/rigid/*) echo 2 ;;
  solver/mesh/*) echo 3 ;;
  solver/fe/* | solver/hlpv/* | solver/axi/*) echo 4 ;;
  solver/post/* | solver/verify/* | solver/material/* | solver/identify/* | solver/snap/* | solver/bistable/*) echo 5 ;;
  solver/grasp/* | solver/study/*) echo 6 ;;
  solver/run.[ch] | solver/main.c | solver/bundle.[ch] | solver/cancel.[ch] | solver/answer.[ch] | solver/solve.[ch] | solver/estimate.[ch]) echo 6 ;;
  server/*) echo 7 ;;
  *) echo 0 ;;
  esac
}
bad=0
count=0
for file in $(find solver server -name '*.[ch]' | sort); do
  from=$(rank "$file")
  [ "$from" -gt 0 ] || { echo "$file belongs to no layer"; bad=1; }
  for included in $(sed -n 's/^#include "\([^"]*\)".*/\1/p' "$file"); do
    count=$((count + 1))
    to=$(rank "$included")
    if [ "$from" = 7 ] && [ "$to" -ge 3 ] && [ "$to" -le 6 ]; then
      echo "$file includes $included: the server uses only base, job and explore of the solver"
      bad=1
    elif [ "$to" -gt "$from" ]; then
      echo "$file includes $included: includes point downwards"
      bad=1
    fi
  done
done
echo "$count includes looked at"
[ "$count" -gt 100 ] && [ "$bad" = 0 ]
