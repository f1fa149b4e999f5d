# A Slurm cluster of virtual nodes on the loopback of this machine, for one test; to be sourced.
#
#   start_cluster FOLDER NODES   starts munged, slurmctld and the slurmds, and sets SLURM_CONF; logs are in FOLDER/log
#   stop_cluster                 cancels what runs and ends the daemons; to be called in a trap
#
# The daemons also end when this shell is killed (PR_SET_PDEATHSIG).
# shellcheck shell=bash

cluster_daemons=()

daemon() {  # LOG COMMAND...
  setpriv --pdeathsig KILL "${@:2}" >"$1" 2>&1 </dev/null &
  cluster_daemons+=($!)
}

is_free() { ! (exec 3<>"/dev/tcp/127.0.0.1/$1") 2>/dev/null; }

# First of COUNT ports in a row that nobody listens on, below those that Linux gives to clients.
free_ports() {  # COUNT
  local first=$((20000 + BASHPID * 16 % 12000)) port
  while :; do
    for ((port = first; port < first + $1; ++port)); do is_free "$port" || break; done
    ((port < first + $1)) || break
    first=$((first + $1))
  done
  echo "$first"
}

write_configuration() {  # FOLDER NODES PORT
  local host
  host=$(uname -n)
  host=${host%%.*}
  cat >"$1/slurm.conf" <<CONF
ClusterName=weft
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$1/munge/sock,cred_expire=5
CryptoType=crypto/munge
SlurmctldPort=$3
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
SlurmctldPidFile=$1/slurmctld.pid
SlurmdPidFile=$1/slurmd-%n.pid
SlurmctldLogFile=$1/log/slurmctld.log
SlurmdLogFile=$1/log/slurmd-%n.log
StateSaveLocation=$1/state
SlurmdSpoolDir=$1/spool-%n
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerType=sched/backfill
SchedulerParameters=sched_interval=1,bf_interval=1
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/filetxt
JobCompLoc=$1/jobcomp.txt
MpiDefault=none
SwitchType=switch/none
ReturnToService=2
SlurmdParameters=config_overrides
SlurmdTimeout=30
KillWait=2
NodeName=n[1-$2] NodeHostname=$host NodeAddr=127.0.0.1 Port=[$(($3 + 1))-$(($3 + $2))] CPUs=1 RealMemory=1000 State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
}

start_cluster() {
  local folder=$1 nodes=$2 node
  mkdir -p "$folder"/{log,state,munge}
  chmod 700 "$folder/munge"
  (umask 077 && head -c 128 /dev/urandom >"$folder/munge/key")
  write_configuration "$folder" "$nodes" "$(free_ports $((nodes + 1)))"
  export SLURM_CONF=$folder/slurm.conf
  daemon "$folder/log/munged.out" munged -F --force --socket="$folder/munge/sock" --key-file="$folder/munge/key" \
    --pid-file="$folder/munge/pid" --log-file="$folder/munge/log" --seed-file="$folder/munge/seed" --num-threads=2
  wait_until 10 test -S "$folder/munge/sock"
  daemon "$folder/log/slurmctld.out" slurmctld -D -i -f "$SLURM_CONF"
  for ((node = 1; node <= nodes; ++node)); do
    daemon "$folder/log/slurmd-n$node.out" slurmd -D -N "n$node" -f "$SLURM_CONF"
  done
  wait_until 30 all_idle "$nodes"
}

all_idle() { [[ $(sinfo -h -N -o %T 2>/dev/null | grep -cx idle) == "$1" ]]; }

wait_until() {  # SECONDS COMMAND...
  local end=$((SECONDS + $1))
  until "${@:2}"; do
    ((SECONDS < end)) || { echo "waited $1 s in vain: ${*:2}" >&2; return 1; }
    sleep 0.1
  done
}

no_jobs() { [[ -z $(squeue -h 2>/dev/null) ]]; }

stop_cluster() {
  if ((${#cluster_daemons[@]})) && [[ -n $(squeue -h 2>/dev/null) ]]; then
    scancel --user="$(id -un)" && wait_until 10 no_jobs || true
  fi
  local i
  # The controller first, so that it does not wait for the nodes.
  for ((i = 1; i < ${#cluster_daemons[@]}; ++i)); do kill "${cluster_daemons[i]}" 2>/dev/null || true; done
  for ((i = 1; i < ${#cluster_daemons[@]}; ++i)); do wait "${cluster_daemons[i]}" 2>/dev/null || true; done
  ((${#cluster_daemons[@]} == 0)) || kill "${cluster_daemons[0]}" 2>/dev/null || true
  wait
}
