#!/bin/bash
# Ends daemons of the throw-away cluster in DIR, nobody else's:
#   cluster_down.sh [--kill] DIR [NAME...]
# NAME: munged, slurmctld, n1, n2, ...; without names all of them. With --kill by SIGKILL, a node
# with the jobs and steps it runs, as if it had lost its power.
set -u
HERE=$(cd "$(dirname "$0")" && pwd)
signal=TERM
if [ "${1:-}" = --kill ]; then
  signal=KILL
  shift
fi
DIR=$(readlink -m "${1:?usage: cluster_down.sh [--kill] DIR [NAME...]}")
shift
. "$HERE/cluster_lib.sh"
[ -s "$DIR/slurm.conf" ] || exit 0

# end NAME: its daemon, and insists after five seconds.
end() {
  local pid
  pid=$(pid_of "$1")
  [ -n "$pid" ] || return 0
  kill "-$signal" "$pid" 2> /dev/null
  for _ in $(seq 100); do
    [ -n "$(pid_of "$1")" ] || return 0
    sleep 0.05
  done
  kill -KILL "$pid" 2> /dev/null
}

# end_steps NODE: what it runs; twice, since a process may start another meanwhile.
end_steps() {
  local steps
  for _ in 1 2; do
    mapfile -t steps < <(steps_of "$1")
    [ "${#steps[@]}" -eq 0 ] || kill -KILL "${steps[@]}" 2> /dev/null
  done
}

mapfile -t all < <(nodes)
all_of_it=no
if [ $# -eq 0 ]; then
  all_of_it=yes
  set -- "${all[@]}" slurmctld munged
fi
for name; do
  end "$name"
  case $name,$signal,$all_of_it in
    munged,* | slurmctld,*) ;;
    *,KILL,* | *,yes) end_steps "$name" ;;
  esac
done
exit 0
