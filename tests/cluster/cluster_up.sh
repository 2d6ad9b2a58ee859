#!/bin/bash
# A throw-away Slurm cluster on loopback: munge, slurmctld and a slurmd a node, with keys, sockets,
# ports, state and logs of their own below DIR, without systemd, control groups or an accounting
# database. Starts what of it does not run yet, so that it also repairs.
#
#   cluster_up.sh DIR             all of it; waits until every node can take work
#   cluster_up.sh DIR NAME...     only these daemons (munged, slurmctld, n1, n2, ...), without waiting
#   export SLURM_CONF=DIR/slurm.conf
#
# Variables for the first start: CLUSTER_NODES (2), CLUSTER_CPUS (2, of each node), CLUSTER_CONF
# (further lines of slurm.conf, in the place of those of the same name). Exit status 77 with a reason
# when Slurm is not installed or does not start here.
# Debian: munge slurmctld slurmd slurm-client slurm-wlm-basic-plugins
set -u
PATH=$PATH:/usr/sbin:/sbin
HERE=$(cd "$(dirname "$0")" && pwd)
DIR=$(readlink -m "${1:?usage: cluster_up.sh DIR [NAME...]}")
shift
. "$HERE/cluster_lib.sh"
export SLURM_CONF=$DIR/slurm.conf

skip() {
  echo "SKIP: $*"
  exit 77
}

# Ports that are free now, all different.
free_ports() {
  python3 - "$1" <<'PYTHON'
import socket, sys
held = [socket.create_server(("127.0.0.1", 0)) for _ in range(int(sys.argv[1]))]
print(*(one.getsockname()[1] for one in held))
PYTHON
}

# Times are short, so that tests see in seconds what takes minutes in a cluster that is used.
configuration() {
  local host user nodes=${CLUSTER_NODES:-2} ports
  host=$(hostname -s)
  user=$(id -un)
  read -ra ports <<< "$(free_ports $((nodes + 1)))"
  cat <<CONF
ClusterName=throwaway
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=${ports[0]}
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket=$DIR/munge/socket
StateSaveLocation=$DIR/state
SlurmdSpoolDir=$DIR/spool/%n
SlurmctldPidFile=$DIR/slurmctld.pid
SlurmdPidFile=$DIR/slurmd-%n.pid
SlurmctldLogFile=$DIR/log/slurmctld
SlurmdLogFile=$DIR/log/%n
SlurmdParameters=config_overrides
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
MailProg=/bin/true
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
DefMemPerCPU=64
SchedulerType=sched/backfill
SchedulerParameters=sched_interval=1,sched_min_interval=0,batch_sched_delay=0,bf_interval=5
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
JobCompType=jobcomp/filetxt
JobCompLoc=$DIR/log/completed
MaxArraySize=20001
MaxJobCount=50000
ReturnToService=2
SlurmctldTimeout=10
SlurmdTimeout=10
MessageTimeout=10
BatchStartTimeout=5
InactiveLimit=0
KillWait=2
CONF
  for ((i = 1; i <= nodes; i++)); do
    echo "NodeName=n$i NodeHostname=$host NodeAddr=127.0.0.1 Port=${ports[i]}" \
      "CPUs=${CLUSTER_CPUS:-2} RealMemory=16384 State=UNKNOWN"
  done
  echo "PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP"
}

# configure: writes slurm.conf, each line of CLUSTER_CONF in the place of that with its name.
configure() {
  local line
  configuration > "$DIR/slurm.conf.new"
  while IFS= read -r line; do
    [ -n "$line" ] || continue
    sed -i "/^${line%%=*}=/d" "$DIR/slurm.conf.new"
    echo "$line" >> "$DIR/slurm.conf.new"
  done <<< "${CLUSTER_CONF:-}"
  mv "$DIR/slurm.conf.new" "$DIR/slurm.conf"
}

start_munged() {
  local key=$DIR/munge/key
  if [ ! -s "$key" ]; then
    (umask 077 && head -c 128 /dev/urandom > "$key")
    chmod 400 "$key"
  fi
  munged --force --num-threads=2 --key-file="$key" --socket="$DIR/munge/socket" \
    --pid-file="$DIR/munge/pid" --log-file="$DIR/munge/log" --seed-file="$DIR/munge/seed"
}

# start NAME: unless it runs.
start() {
  [ -z "$(pid_of "$1")" ] || return 0
  case $1 in
    munged) start_munged ;;
    slurmctld) slurmctld -f "$SLURM_CONF" ;;
    *) mkdir -p "$DIR/spool/$1" && slurmd -N "$1" -f "$SLURM_CONF" ;;
  esac >> "$DIR/log/start" 2>&1
}

missing=()
for program in munged slurmctld slurmd sbatch squeue scancel scontrol python3; do
  command -v "$program" > /dev/null || missing+=("$program")
done
[ "${#missing[@]}" -eq 0 ] || skip "no Slurm cluster can be started, not installed: ${missing[*]}"

umask 022
mkdir -p "$DIR"/{munge,state,spool,log} && chmod 711 "$DIR/munge"
cd "$DIR" || exit 1
[ -s slurm.conf ] || configure
wait=no
if [ $# -eq 0 ]; then
  wait=yes
  mapfile -t names < <(nodes)
  set -- munged slurmctld "${names[@]}"
fi
for name; do
  start "$name" || skip "$name does not start: $(tail -n 3 "$DIR/log/start")"
done
[ "$wait" = yes ] || exit 0
count=$(nodes | wc -l)
for _ in $(seq 600); do
  [ "$(sinfo -h -N -t idle,mixed,allocated,completing -o %N 2> /dev/null | sort -u | wc -l)" = "$count" ] && exit 0
  sleep 0.1
done
skip "no Slurm cluster after a minute: $(sinfo -h -N -o '%N %T %E' 2>&1) $(tail -n 3 "$DIR/log/slurmctld")"
