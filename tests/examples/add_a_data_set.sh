#!/usr/bin/env bash
# add_a_data_set.sh: brings scans of one's own into a layout that mosbench reads, without a line of
# C++: velodyne/*.bin (float32 x, y, z, intensity), poses.txt and, if there is truth, labels/*.label
# (uint32, 9 static, 251 moving). Here the scans come from CSV rows of x, y, z and moving, and the poses
# from a TUM file (stamp, translation, quaternion). Expects mosbench in PATH. A layout that mosbench shall
# recognise takes a row in datasets/layouts; docs/data/data.md has the steps.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir -p "$folder/csv" "$folder/own/velodyne" "$folder/own/labels"

# Twenty scans of a wall 8 m ahead and a box in front of it that moves by 0.5 m per scan.
python3 - "$folder/csv" <<'PYTHON'
import pathlib, sys
folder = pathlib.Path(sys.argv[1])
grid = [(0.1 * a, 0.1 * b) for a in range(-60, 60) for b in range(-10, 20)]
with open(folder / "poses.tum", "w") as poses:
    for k in range(20):
        wall = [f"8,{y},{z},0" for y, z in grid]
        box = [f"4,{0.5 * k - 5 + y},{z},1" for y, z in grid if abs(y) < 0.4 and z < 0.8]
        (folder / f"{k:06d}.csv").write_text("\n".join(["x,y,z,moving", *wall, *box]) + "\n")
        poses.write(f"{0.1 * k} 0 0 0 0 0 0 1\n")
PYTHON

# The conversion: this part is yours.
python3 - "$folder/csv" "$folder/own" <<'PYTHON'
import csv, pathlib, struct, sys
source, target = map(pathlib.Path, sys.argv[1:])
for file in sorted(source.glob("*.csv")):
    rows = list(csv.DictReader(file.open()))
    scan = b"".join(struct.pack("<4f", float(r["x"]), float(r["y"]), float(r["z"]), 0) for r in rows)
    truth = b"".join(struct.pack("<I", 251 if r["moving"] == "1" else 9) for r in rows)
    (target / "velodyne" / f"{file.stem}.bin").write_bytes(scan)
    (target / "labels" / f"{file.stem}.label").write_bytes(truth)
    with (target / "times.txt").open("a") as times:
        times.write(f"{0.1 * int(file.stem)}\n")
PYTHON

mosbench doctor "$folder/own" --dataset semantickitti --poses "$folder/csv/poses.tum"
mosbench run "$folder/own" --dataset semantickitti --poses "$folder/csv/poses.tum" --out "$folder/run"
