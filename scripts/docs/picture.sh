#!/usr/bin/env bash
# picture.sh [MOSBENCH]: takes results/report.png again, the picture of the report in the README: a
# simulated drive, segmented and shown in headless Chromium. Needs what setup.sh --page installs.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
mosbench=${1:-build/release/eval/mosbench}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
"$mosbench" simulate --layout semantickitti --scene street --scans 60 --seed 1 --out "$scratch/street"
"$mosbench" run "$scratch/street" --preset semantickitti --out "$scratch/runs/street"
"$mosbench" report "$scratch/runs/street" -o "$scratch/report.html"
node tests/page/report_picture.mjs "$scratch/report.html" results/report.png 53
