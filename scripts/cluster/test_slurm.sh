#!/usr/bin/env bash
# test_slurm.sh [--cells N] [--program FILE]: computes a study of N cells (20 or 200) on a Slurm of its own, drains
# the node and kills a job and the scheduler in the middle, runs the same command again, and checks that every
# cell is there, that none was computed twice, and that all are, bit for bit, those of a run without Slurm.
# Ends with exit code 77 and a message where Slurm cannot start.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
mosbench=$here/../../build/release/eval/mosbench cells=20
while [ $# -gt 0 ]; do
  case $1 in
    --cells) cells=$2 ;;
    --program) mosbench=$2 ;;
    *) echo "usage: test_slurm.sh [--cells 20|200] [--program FILE]" >&2; exit 2 ;;
  esac
  shift 2
done
case $cells in
  20) strengths='0.01, 0.02, 0.05' seeds='1, 2, 3' ;;
  200) strengths='0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.09' seeds='1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11' ;;
  *) echo "test_slurm.sh: --cells $cells, expected 20 or 200" >&2; exit 2 ;;
esac
command -v snakemake >/dev/null || { echo "test_slurm.sh: snakemake is not installed (scripts/setup.sh --cluster)"; exit 77; }

dir=$(mktemp -d)
finish() { "$here/slurm_here.sh" stop "$dir/slurm" || true; rm -rf "$dir"; }
trap finish EXIT
"$here/slurm_here.sh" start "$dir/slurm" || exit 77
export SLURM_CONF=$dir/slurm/slurm.conf
node=$(sinfo -h -o %N)
cat >"$dir/study.yaml" <<YAML
name: slurm
protocol: semantickitti-mos
data: {name: room, simulate: {layout: semantickitti, scene: room, scans: 8, seed: 1}}
methods: [hmm-mos, underwood]
disturb: {kind: range_noise_m, strengths: [$strengths]}
seeds: [$seeds]
YAML

study() { "$mosbench" run "$dir/study.yaml" --out "$dir/$1" "${@:2}"; }
done_cells() { find "$dir/cluster/cells" -name result.json ! -path '*/.*' 2>/dev/null | wc -l; }
running_job() { squeue -h -t R -o %i | head -n 1; }
check() { if ! "${@:2}"; then echo "test_slurm.sh: FAILED: $1" >&2; exit 1; fi; echo "ok: $1"; }

# wait_for SECONDS CONDITION...
wait_for() {
  local end=$((SECONDS + $1))
  until "${@:2}"; do
    [ "$SECONDS" -lt "$end" ] || return 1
    sleep 0.2
  done
}
has_some() { [ "$(done_cells)" -ge "$1" ]; }
has_job() { [ -n "$(running_job)" ]; }

"$mosbench" run "$dir/study.yaml" --out "$dir/cluster" --on slurm --yes >"$dir/first.log" 2>&1 &
scheduler=$!
check "cells are computed by jobs" wait_for 120 has_some 3
job=$(running_job)
scontrol update NodeName="$node" State=DRAIN Reason=test
if [ -n "$job" ]; then scancel --signal=KILL "$job"; fi
echo "drained $node and killed job ${job:-(none was running)} with $(done_cells) of $cells cells done"
sleep 2
snakemake=$(pgrep -P "$scheduler")
kill -9 "$scheduler" "$snakemake"
wait "$scheduler" 2>/dev/null || true
scancel --user=root || true
wait_for 60 test -z "$(squeue -h -t R -o %i)" || true
scontrol update NodeName="$node" State=RESUME
before=$(done_cells)
check "the scheduler was killed in the middle" [ "$before" -lt "$cells" ]

study cluster --on slurm --yes >"$dir/second.log" 2>&1 || { tail -n 40 "$dir/second.log"; exit 1; }
check "the same command completed it" [ "$(done_cells)" = "$cells" ]
scontrol -o show jobs | grep -o 'JobId=[0-9]*\|JobName=[^ ]*\|JobState=[A-Z]*\|RunTime=[^ ]*' | paste -d' ' - - - -
twice=$(cat "$dir"/cluster/slurm/*.log | grep ' computed: ' | cut -d' ' -f1 | sort | uniq -d | wc -l)
check "no cell was computed twice" [ "$twice" = 0 ]

study local --on local --yes >"$dir/local.log" 2>&1
for file in "$dir"/local/cells/*/result.json; do
  cmp -s <(jq 'del(.timing, .places)' "$file") <(jq 'del(.timing, .places)' "$dir/cluster/${file#"$dir/local/"}") || {
    echo "test_slurm.sh: FAILED: ${file#"$dir/local/"} differs" >&2
    exit 1
  }
done
echo "ok: $cells cells are those of a local run, bit for bit"
