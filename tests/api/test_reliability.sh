#!/bin/bash
# Short runs of the scripts of tests/reliability, without their limits of time: other tests run on
# this machine meanwhile.
. "$(dirname "$0")/lib.sh"
SCRIPTS=$(cd "$(dirname "$0")/../reliability" && pwd)
export BIN PYTHONDONTWRITEBYTECODE=1
: > "$WORK/stderr"

run() {
  python3 "$SCRIPTS/$1" "${@:2}" > "$WORK/$1.txt" 2>&1
  check "$1" 0 $?
  grep -E 'BROKEN|Error|Traceback|SKIPPED' -A 3 "$WORK/$1.txt"
}

run kill_daemon.py --rounds 5 --ready 60
run kill_worker.py --kills 4 --noticed 60
run idempotency.py --clients 50 --keys 1
run disk.py --every 4 --once 3 --seconds 0.3 --fillings 1 --back 60
run day.py --minutes 0.1 --load 2 --brief
finish
