#!/usr/bin/env bash
# A throw-away Slurm on this machine, for tests: local.sh start FOLDER, then source FOLDER/env; local.sh stop FOLDER.
# Four nodes of one processor each, on loopback only, with everything it writes in FOLDER, whose path must be short
# (it holds a socket). Needs Debian's slurmctld, slurmd, slurm-client and munge; runs as whoever calls it.
set -euo pipefail
PATH=$PATH:/usr/sbin:/sbin
NODES=4
folder=$(realpath -m "$2")

free_port() {
    local port
    while :; do
        port=$((20000 + RANDOM % 12000))
        if ! (: <"/dev/tcp/127.0.0.1/$port") 2>/dev/null; then
            echo "$port"
            return
        fi
    done
}

start() {
    mkdir -p "$folder"/{key,state,log,run}
    chmod 700 "$folder/key"
    chmod 755 "$folder" "$folder/run"
    (umask 077 && head -c 256 /dev/urandom >"$folder/key/munge")
    munged --key-file="$folder/key/munge" --socket="$folder/run/munge" --pid-file="$folder/run/munged.pid" \
        --log-file="$folder/key/log" --seed-file="$folder/key/seed" --origin=127.0.0.1
    {
        echo "ClusterName=test"
        echo "SlurmctldHost=$(hostname -s)(127.0.0.1)"
        echo "SlurmctldPort=$(free_port)"
        echo "SlurmUser=$(id -un)"
        echo "SlurmdUser=$(id -un)"
        echo "AuthType=auth/munge"
        echo "CredType=cred/munge"
        echo "AuthInfo=socket=$folder/run/munge,cred_expire=5"
        echo "CommunicationParameters=NoInAddrAny,NoCtldInAddrAny"
        echo "ProctrackType=proctrack/linuxproc"
        echo "TaskPlugin=task/none"
        echo "JobAcctGatherType=jobacct_gather/none"
        echo "AccountingStorageType=accounting_storage/none"
        echo "SelectType=select/cons_tres"
        echo "SelectTypeParameters=CR_CPU"
        echo "SchedulerParameters=batch_sched_delay=0,bf_interval=1,sched_interval=1"
        echo "SwitchType=switch/none"
        echo "MpiDefault=none"
        echo "ReturnToService=2"
        echo "KillWait=2"
        echo "MaxArraySize=${MAX_ARRAY_SIZE:-1001}"
        echo "StateSaveLocation=$folder/state"
        echo "SlurmdSpoolDir=$folder/spool-%n"
        echo "SlurmctldPidFile=$folder/run/slurmctld.pid"
        echo "SlurmdPidFile=$folder/run/slurmd-%n.pid"
        echo "SlurmctldLogFile=$folder/log/slurmctld"
        echo "SlurmdLogFile=$folder/log/slurmd-%n"
        for node in $(seq $NODES); do
            mkdir -p "$folder/spool-n$node"
            echo "NodeName=n$node NodeHostname=$(hostname -s) NodeAddr=127.0.0.1 Port=$(free_port) CPUs=1 State=UNKNOWN"
        done
        echo "PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP"
    } >"$folder/slurm.conf"
    echo "export SLURM_CONF=$folder/slurm.conf" >"$folder/env"
    export SLURM_CONF=$folder/slurm.conf
    slurmctld -f "$SLURM_CONF" -c
    for node in $(seq $NODES); do slurmd -f "$SLURM_CONF" -N "n$node"; done
    for _ in $(seq 300); do
        if [ "$(sinfo -h -N -t idle -o %N 2>/dev/null | wc -l)" = $NODES ]; then return; fi
        sleep 0.1
    done
    sinfo -N >&2 || true
    tail -n 20 "$folder"/log/* >&2
    echo "the nodes did not come up" >&2
    exit 1
}

stop() {
    export SLURM_CONF=$folder/slurm.conf
    scancel --user="$(id -un)" 2>/dev/null || true
    for pid in "$folder"/run/slurmd-*.pid "$folder/run/slurmctld.pid" "$folder/run/munged.pid"; do
        if [ -s "$pid" ]; then kill "$(cat "$pid")" 2>/dev/null || true; fi
    done
}

"$1"
