#!/bin/bash
# What `make install` makes: programs that find each other, manual pages in step with --help, a unit
# that systemd understands; and `make uninstall` leaves nothing.
. "$(dirname "$0")/lib.sh"
REPOSITORY=$(cd "$(dirname "$0")/../.." && pwd)
ROOT=$WORK/root
[ -f Makefile ] || { echo "SKIP: not in a build directory"; exit 77; }
env -u MAKEFLAGS -u MAKELEVEL make -s install DESTDIR="$ROOT" > "$WORK/install" 2>&1
check "make install" 0 $?
BIN=$(dirname "$(find "$ROOT" -type f -name pneulabd)")
MAN=$(dirname "$(dirname "$(find "$ROOT" -name pneulabd.8)")")
check "the daemon is in bin" bin "$(basename "$BIN")"

limit=2048
# The shadow memory of a sanitizer does not fit under a limit of private memory.
grep -aqE '__(asan|tsan)_init' "$BIN/pneulab-solve" && limit=0
start_daemon --workers 1 --memory-limit $limit
fetch POST /api/v1/jobs -H 'Prefer: wait=60' --data-binary @"$REPOSITORY/jobs/beast/20A-0.18.json"
check "the installed daemon solves a job" succeeded "$(field .state)"
stop_daemon TERM

# options_of PROGRAM: long options of its help.
options_of() {
  "$1" --help | grep -Eo '^ +(-[a-zA-Z], )?--[a-z-]+' | grep -Eo -- '--[a-z-]+' | sort -u
}

for page in pneulabd:8 pneulab-solve:1 pneulab-launch:8; do
  program=${page%:*} file=$MAN/man${page#*:}/${page%:*}.${page#*:}
  check "$program: the manual has the options of --help" \
    "$(options_of "$(find "$ROOT" -type f -name "$program")")" \
    "$(sed -n 's/^\.It \(Fl . , \)\{0,1\}Fl \\-\([a-z-]*\).*/--\2/p' "$file" | sort -u)"
done
if command -v mandoc > /dev/null; then
  for file in "$MAN"/man?/pneulab*; do
    check "$(basename "$file") is clean" "" "$(mandoc -T lint -W warning "$file" 2>&1)"
    check_match "$(basename "$file") is readable" 'PNEULAB' "$(mandoc -T ascii "$file")"
  done
else
  echo "mandoc is not installed: the manual pages are not checked"
fi

unit=$(find "$ROOT" -name pneulabd.service)
program=$(sed -n 's/^ExecStart=\([^ ]*\).*/\1/p' "$unit")
check "the unit starts the installed daemon" "$BIN/pneulabd" "$ROOT$program"
if command -v systemd-analyze > /dev/null; then
  mkdir "$WORK/units"
  sed "s|^ExecStart=[^ ]*|ExecStart=$BIN/pneulabd|; /^Documentation/d" "$unit" > "$WORK/units/pneulabd.service"
  check "systemd understands the unit" "" \
    "$(systemd-analyze verify "$WORK/units/pneulabd.service" 2>&1 | grep pneulabd)"
  check_match "little is exposed" '^([0-2][.]|3[.]0)' \
    "$(systemd-analyze security --offline=yes "$WORK/units/pneulabd.service" 2> /dev/null | sed -n 's/.*level for pneulabd.service: \([0-9.]*\).*/\1/p')"
else
  echo "systemd-analyze is not installed: the unit is not checked"
fi

env -u MAKEFLAGS -u MAKELEVEL make -s uninstall DESTDIR="$ROOT" > "$WORK/install" 2>&1
check "make uninstall" 0 $?
check "leaves nothing" "" "$(find "$ROOT" -type f)"
BIN=$PWD
finish
