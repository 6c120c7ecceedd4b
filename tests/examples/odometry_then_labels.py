#!/usr/bin/env python3
"""Finds the poses of raw scans, compares them with true ones, and labels the scans with them."""

import tempfile

import mosbench


def main(folder: str) -> None:
    sequence = mosbench.open(mosbench.simulate(f"{folder}/street", scene="street", scans=20), sequence="08")
    poses = mosbench.odometry(sequence, kind="simple", min_range_m=1.5)
    errors = mosbench.evaluate_trajectory(poses, sequence.gt_poses, align="origin")
    off_m = errors["sequences"][0]["absolute"]["translation_m"]["rmse"]
    print(f"the poses are {off_m:.3f} m off")

    mos = mosbench.MOS({"max_range_m": 30.0, "min_otsu_score": 1})
    tp = fp = fn = 0
    for scan, pose in zip(sequence, poses):
        for result in mos.push(scan.points, pose):
            counts = mosbench.confusion(result.labels, scan.truth)
            tp, fp, fn = tp + counts["tp"], fp + counts["fp"], fn + counts["fn"]
    print(f"IoU with these poses: {tp / (tp + fp + fn):.3f}")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        main(scratch)
