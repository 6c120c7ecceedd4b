#!/usr/bin/env bash
# gate.sh [MOSBENCH]: segments the simulated sequences of results/baseline again and fails when their IoU
# dropped. With BLESS=1 it accepts the new results instead; commit them.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
mosbench=${1:-build/release/eval/mosbench}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# gate NAME LAYOUT SCENE SCANS PRESET
gate() {
  "$mosbench" simulate --layout "$2" --scene "$3" --scans "$4" --seed 1 --out "$scratch/$1" 2>&1
  "$mosbench" run "$scratch/$1" --preset "$5" --out "$scratch/runs/$1" 2>&1
  if [ "${BLESS:-0}" = 1 ]; then
    "$mosbench" bless "$scratch/runs/$1" "results/baseline/$1" --even-if
  else
    "$mosbench" compare "results/baseline/$1" "$scratch/runs/$1"
  fi
}

gate highway-online semantickitti highway 60 semantickitti
gate street-delayed semantickitti street 60 helimos-delayed
