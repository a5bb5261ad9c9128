#!/usr/bin/env bash
# Runs apps/cluster/sweep.sbatch under a Slurm of its own, controller and node on this machine's loopback: a sweep of twelve
# shards, one of which is killed midway and requeued by Slurm, and one is run twice, joined to what an unsharded run gives but
# for times. Needs root; installs Slurm's packages, and starts nothing that outlives it. Not part of the tests that run everywhere.
#   tests/external/slurm.sh            KESTREL names the program (default: build/bin/kestrel)
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
export KESTREL=$(realpath "${KESTREL:-$root/build/bin/kestrel}") KESTREL_SOURCE=$root
[ "$(id -u)" -eq 0 ] || { echo "slurm.sh: needs root" >&2; exit 3; }
# Their own services are not started: what runs here is told by the files below.
for tool in slurmctld slurmd munged sbatch; do
    command -v $tool >/dev/null || { RUNLEVEL=1 DEBIAN_FRONTEND=noninteractive apt-get install -y -qq slurmctld slurmd slurm-client munge >/dev/null; break; }
done
temporary=$(mktemp -d)
services=()
finish() {
    kill "${services[@]}" 2>/dev/null || true
    wait 2>/dev/null || true
    rm -rf "$temporary"
}
trap finish EXIT
chmod 755 "$temporary"
mkdir -p "$temporary"/{state,spool,munge}
chmod 700 "$temporary/munge"
head -c 128 /dev/urandom >"$temporary/munge/key"
chmod 400 "$temporary/munge/key"
munged --foreground --force --key-file="$temporary/munge/key" --socket="$temporary/munge.socket" --pid-file="$temporary/munge/pid" \
    --log-file="$temporary/munge/log" --seed-file="$temporary/munge/seed" 2>/dev/null &
services+=($!)
node=$(hostname -s)
export SLURM_CONF=$temporary/slurm.conf
cat >"$SLURM_CONF" <<CONF
ClusterName=kestrel
SlurmctldHost=$node(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$temporary/munge.socket
CommunicationParameters=NoInAddrAny
SlurmctldPort=16817
SlurmdPort=16818
StateSaveLocation=$temporary/state
SlurmdSpoolDir=$temporary/spool
SlurmctldPidFile=$temporary/ctld.pid
SlurmdPidFile=$temporary/d.pid
SlurmctldLogFile=$temporary/ctld.log
SlurmdLogFile=$temporary/d.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
# A worker that is killed has this status, and is started again.
RequeueExit=137
NodeName=$node NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES OverSubscribe=NO State=UP
CONF
# Control groups are the machine's; before version 23 they could not be left alone.
[ "$(slurmd -V | sed 's/[^0-9]*\([0-9]*\).*/\1/')" -lt 23 ] || echo CgroupPlugin=disabled >"$temporary/cgroup.conf"
slurmctld -D 2>/dev/null &
services+=($!)
slurmd -D -N "$node" 2>/dev/null &
services+=($!)
for _ in $(seq 60); do
    sinfo -h -o %T 2>/dev/null | grep -q idle && break
    sleep 1
done
sinfo -h -o %T | grep -q idle || { tail -n 5 "$temporary"/*.log >&2; exit 1; }
echo "Slurm $(sinfo --version | awk '{ print $2 }'), node $node"

# Six scenes with two plots each.
python3 - "$root" "$temporary/study.json" <<'PYTHON'
import json, sys
sys.path.insert(0, sys.argv[1] + "/tests/cli")
from sweep_test import TINY
names = ["blob", "tower", "hall", "grove", "pool", "cornell"]
json.dump({**TINY, "scenes": [{"name": name, "source": f"builtin:{name}?detail=0.05"} for name in names]}, open(sys.argv[2], "w"))
PYTHON
out=$temporary/out
cd "$temporary"
"$KESTREL" -q sweep study.json --out whole
quietly() { sbatch --parsable --output=/dev/null "$@"; }
job=$(quietly --array=1-12 "$root/apps/cluster/sweep.sbatch" study.json "$out")
# The fifth shard, once something of it is measured.
until [ -n "$(find "$out/begun/5-$(hostname)/parts" -name picture.json 2>/dev/null)" ]; do sleep 0.05; done
kill -KILL "$(pgrep -f -- "sweep study.json --shard 5/12")"
echo "shard 5 killed"
for _ in $(seq 600); do
    # What is requeued waits two minutes by itself.
    squeue -h -j "$job" -t PD -o %A 2>/dev/null | xargs -r -I JOB scontrol update JobId=JOB StartTime=now 2>/dev/null || true
    [ -z "$(squeue -h -j "$job" 2>/dev/null)" ] && break
    sleep 1
done
restarts=$(scontrol show job "${job}_5" | sed -n 's/.*Restarts=\([0-9]*\).*/\1/p')
[ "$restarts" = 1 ] || { echo "slurm.sh: shard 5 was requeued '$restarts' times" >&2; exit 1; }
echo "shard 5 requeued"
before=$(stat -c %Y "$out/done/7/results.json")
again=$(quietly --wait "$root/apps/cluster/sweep.sbatch" study.json "$out" 7 12)
[ "$before" = "$(stat -c %Y "$out/done/7/results.json")" ]
echo "shard 7 run twice (job $again): nothing was measured again"
"$KESTREL" -q sweep study.json --out joined --merge "$out"/done/*
python3 - "$root" "$temporary" <<'PYTHON'
import sys
sys.path.insert(0, sys.argv[1] + "/tests/cli")
from sweep_test import results, without_times
whole, joined = [without_times(results(f"{sys.argv[2]}/{name}")) for name in ["whole", "joined"]]
if whole != joined:
    sys.exit("slurm.sh: the joined shards are not what one run measures")
print(f"{len(joined['rows'])} rows of twelve shards are those of one run, but for times")
PYTHON
