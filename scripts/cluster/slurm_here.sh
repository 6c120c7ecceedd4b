#!/usr/bin/env bash
# slurm_here.sh start|stop DIR: starts Slurm with one node of two cores on loopback, all of it in DIR, or ends it.
# Touches nothing of the system's configuration; the daemons are ended by their pid files. Needs root and the
# packages of `scripts/setup.sh --cluster`; where it cannot start it ends with exit code 77 and a message.
# Then `export SLURM_CONF=DIR/slurm.conf`, and sbatch, squeue and scontrol are those of this Slurm.
set -euo pipefail
usage() { echo "usage: slurm_here.sh start|stop DIR" >&2; exit 2; }
[ $# = 2 ] || usage
mkdir -p "$2"
dir=$(cd "$2" && pwd)
export SLURM_CONF=$dir/slurm.conf

cannot() { echo "slurm_here.sh: $1" >&2; stop; exit 77; }

# end NAME: ends the daemon of a pid file and waits until it is gone.
end() {
  local pid
  [ -f "$dir/$1.pid" ] || return 0
  pid=$(cat "$dir/$1.pid")
  kill "$pid" 2>/dev/null || true
  for _ in $(seq 50); do
    kill -0 "$pid" 2>/dev/null || break
    sleep 0.2
  done
  rm -f "$dir/$1.pid"
}

stop() {
  end slurmd
  end slurmctld
  end munged
}

# Two ports that nothing listens on.
free_ports() {
  python3 -c 'import socket
sockets = [socket.socket() for _ in range(2)]
for one in sockets: one.bind(("127.0.0.1", 0))
print(*(one.getsockname()[1] for one in sockets))'
}

write_conf() {
  local host controller_port node_port
  host=$(hostname -s)
  read -r controller_port node_port < <(free_ports)
  cat >"$SLURM_CONF" <<CONF
ClusterName=mosbench
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$controller_port
SlurmdPort=$node_port
AuthType=auth/munge
AuthInfo=socket=$dir/munge.sock
CredType=cred/munge
SlurmUser=root
SlurmdUser=root
StateSaveLocation=$dir/state
SlurmdSpoolDir=$dir/spool
SlurmctldPidFile=$dir/slurmctld.pid
SlurmdPidFile=$dir/slurmd.pid
SlurmctldLogFile=$dir/slurmctld.log
SlurmdLogFile=$dir/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
MpiDefault=none
MinJobAge=600
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 RealMemory=8000
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
}

start() {
  local name
  [ "$(id -u)" = 0 ] || cannot "needs root"
  for name in munged slurmctld slurmd; do
    command -v "$name" >/dev/null || PATH=$PATH:/usr/sbin command -v "$name" >/dev/null ||
      cannot "$name is not installed (scripts/setup.sh --cluster)"
  done
  export PATH=$PATH:/usr/sbin
  mkdir -p "$dir/state" "$dir/spool"
  chmod 755 "$dir"
  head -c 1024 /dev/urandom >"$dir/munge.key"
  chmod 600 "$dir/munge.key"
  write_conf
  munged --force --key-file="$dir/munge.key" --socket="$dir/munge.sock" --pid-file="$dir/munged.pid" \
    --log-file="$dir/munged.log" --seed-file="$dir/munge.seed" || cannot "munged does not start"
  slurmctld || cannot "slurmctld does not start, see $dir/slurmctld.log"
  sleep 3
  slurmd || cannot "slurmd does not start, see $dir/slurmd.log"
  for _ in $(seq 30); do
    if sinfo -h -o %T 2>/dev/null | grep -q idle; then return 0; fi
    sleep 1
  done
  cannot "the node does not become idle, see $dir/slurmctld.log"
}

case $1 in
  start | stop) "$1" ;;
  *) usage ;;
esac
