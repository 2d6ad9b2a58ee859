# shellcheck shell=bash
# Shared by cluster_up.sh and cluster_down.sh: the daemons of a throw-away cluster in DIR, by name:
# munged, slurmctld, and n1, n2, ... for the slurmd of each node.

# nodes: the names of the cluster's nodes.
nodes() {
  sed -n 's/^NodeName=\([^ ]*\) .*/\1/p' "$DIR/slurm.conf"
}

# pid_of NAME: the process of a daemon, nothing when it does not run. A file with the number of a
# process that was killed stays behind, and another process may have got that number.
pid_of() {
  local file pid program
  case $1 in
    munged) file=$DIR/munge/pid program=munged ;;
    slurmctld) file=$DIR/slurmctld.pid program=slurmctld ;;
    *) file=$DIR/slurmd-$1.pid program=slurmd ;;
  esac
  pid=$(cat "$file" 2> /dev/null) || return 0
  if [ "$(cat "/proc/$pid/comm" 2> /dev/null)" = "$program" ] &&
    [ "$(sed 's/.*) //; s/ .*//' "/proc/$pid/stat" 2> /dev/null)" != Z ]; then
    echo "$pid"
  fi
}

# steps_of NODE: the processes that Slurm has started on a node, with all below them. A slurmstepd
# keeps the log of its node open, by which it is told from those of other clusters of this machine.
steps_of() {
  local roots
  roots=$(find /proc/[0-9]*/fd -lname "$DIR/log/$1" 2> /dev/null | cut -d/ -f3 | sort -un |
    while read -r pid; do
      [ "$(cat "/proc/$pid/comm" 2> /dev/null)" = slurmstepd ] && echo "$pid"
    done)
  ps -e -o pid=,ppid= | awk -v roots="$roots" '
    BEGIN { for (n = split(roots, root, "\n"); n > 0; n--) below[root[n]] = 1 }
    { parent[$1] = $2 }
    END {
      do {
        more = 0
        for (pid in parent) if (!(pid in below) && parent[pid] in below) below[pid] = more = 1
      } while (more)
      for (pid in below) if (pid) print pid
    }'
}
