#!/usr/bin/env bash
# score_labels.sh: scores the labels of any program, here of label_scans.cpp, and compares them with
# the labels of `mosbench run`. Expects mosbench and label_scans in PATH.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mosbench simulate --layout sipailou --scene room --scans 12 --seed 1 --out "$folder/data"
sequence=$(find "$folder/data" -name velodyne -printf '%h\n' | head -n 1)

label_scans "$sequence" "$folder/mine"
mosbench score "$sequence" --predictions "$folder/mine" --method "my method" --out "$folder/scored"
mosbench stats "$folder/scored"

mosbench run "$sequence" --preset doals-20m --set max_range_m=50 --out "$folder/run"
diff -r "$folder/mine" "$folder"/run/*/labels
echo "label_scans and mosbench run give the same labels"
