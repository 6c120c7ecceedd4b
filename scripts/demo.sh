#!/usr/bin/env bash
# demo.sh: installs missing packages, builds release, simulates a small sequence in the layout of each of
# four data sets, segments and scores them, prints one table and writes a report of all to build/demo.
# Leaves out what it does not need, unless MOSBENCH_WITH_ROSBAG or MOSBENCH_WITH_HDF5 is ON, and says so.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
export MOSBENCH_WITH_PCL=OFF MOSBENCH_WITH_ROSBAG=${MOSBENCH_WITH_ROSBAG:-OFF}
export MOSBENCH_WITH_HDF5=${MOSBENCH_WITH_HDF5:-OFF}
export MOSBENCH_BUILD_TESTS=OFF MOSBENCH_BUILD_BENCH=OFF MOSBENCH_PRECOMPILED_HEADERS=ON
scripts/setup.sh
scripts/build.sh release --target mosbench
mosbench=build/release/eval/mosbench
demo=build/demo
rm -rf "$demo"
mkdir -p "$demo"

# show LAYOUT SCENE SCANS PRESET: takes one data set from the scene to rows of the table: of the paper's
# method, and of preset best.
show() {
  "$mosbench" simulate --layout "$1" --scene "$2" --scans "$3" --seed 1 --out "$demo/$1" >&2
  segment "$1" "$2" "$4" "$demo/runs/$1"
  segment "$1" "$2" best "$demo/best/$1"
}

# segment LAYOUT SCENE PRESET RUNS: segments and scores a data set; a row per sequence.
segment() {
  local data=$demo/$1 runs=$4 run=$demo/$1-$3-run.json score=$demo/$1-$3-score.json
  "$mosbench" run "$data" --preset "$3" --write scores --out "$runs" --json >"$run"
  "$mosbench" score "$data" --predictions "$runs" --json \
    --protocol "$(jq -r .protocol "$run")" >"$score"
  # Scoring the label files again must give the numbers of the run.
  if ! cmp -s <(jq '[.sequences[].summary]' "$run") <(jq '[.sequences[].summary]' "$score"); then
    echo "demo.sh: run and score differ, see $run and $score" >&2
    exit 1
  fi
  jq -r --arg data "$1" --arg scene "$2" --arg preset "$3" '
    def percent: if . == null then "undefined" else (1000 * . | round / 10 | tostring) + " %" end;
    .protocol as $protocol | .sequences[] |
    [$data, $scene, .name, $preset, .scans, $protocol, (.summary | .iou, .precision, .recall | percent),
     (10 * .method_ms_per_scan | round / 10)] | @tsv' "$run" >>"$demo/table.tsv"
}

printf '%s\t' dataset scene sequence preset scans protocol IoU precision recall >"$demo/table.tsv"
printf 'ms/scan\n' >>"$demo/table.tsv"
show doals mall 100 doals-20m
show sipailou campus 200 sipailou
show helimos street 60 helimos
show semantickitti highway 60 semantickitti

echo
echo "Simulated sequences: they show that everything works, not how well a method does on real ones. The preset
of the data set is the paper's method; best is hmm-mos-plus."
column -t -s $'\t' -R 5,7,8,9,10 "$demo/table.tsv"

# Of each of the paper's seven results the worst scans and some others, so that the file opens quickly. The command
# says what it leaves out.
"$mosbench" report "$demo"/runs/* -o "$demo/report.html" --max-mb 15

echo
echo "Left out of this build: the tests; scripts/test.sh installs and builds everything."
[ "$MOSBENCH_WITH_ROSBAG" != OFF ] || echo "  Writing bags needs ROS's library: MOSBENCH_WITH_ROSBAG=ON scripts/demo.sh (40 packages more)"
[ "$MOSBENCH_WITH_HDF5" != OFF ] || echo "  Reading .h5 files needs libhdf5: MOSBENCH_WITH_HDF5=ON scripts/demo.sh (30 packages more)"
