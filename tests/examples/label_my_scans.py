#!/usr/bin/env python3
"""label_my_scans.py [SEQUENCE OUT]: labels scans that this script reads itself, one after the other.

SEQUENCE holds velodyne/*.bin (float32 x, y, z, intensity) and poses.txt (12 numbers per scan, map from
sensor). Without arguments a simulated street is labelled.
"""

import pathlib
import sys
import tempfile

import numpy as np

import mosbench


def main(sequence: pathlib.Path, out: pathlib.Path) -> None:
    poses = np.tile(np.eye(4), (len(list(sequence.glob("velodyne/*.bin"))), 1, 1))
    poses[:, :3] = np.loadtxt(sequence / "poses.txt").reshape(-1, 3, 4)
    files = sorted(sequence.glob("velodyne/*.bin"))
    out.mkdir(parents=True, exist_ok=True)

    config = mosbench.Config.preset("sipailou").replace(max_range_m=40.0, min_otsu_score=1)
    mos = mosbench.MOS(config, scan_count=len(files))
    results = []
    for file, pose in zip(files, poses):
        points = np.fromfile(file, dtype=np.float32).reshape(-1, 4)
        results += mos.push(points, pose)  # none or several where the method waits for later scans
    results += mos.finish()

    for result in results:
        result.labels.tofile(out / f"{files[result.index].stem}.label")
        print(f"{files[result.index].name}: {result.moving.sum()} of {len(result.moving)} points move")


if __name__ == "__main__":
    if len(sys.argv) == 3:
        main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]))
    else:
        with tempfile.TemporaryDirectory() as folder:
            data = mosbench.simulate(f"{folder}/street", layout="sipailou", scans=20)
            main(next(data.rglob("velodyne")).parent, pathlib.Path(folder, "labels"))
