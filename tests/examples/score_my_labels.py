#!/usr/bin/env python3
"""Scores the labels of a network by a benchmark's rules, in Python and by the program.

Here the "network" calls moving what is nearer than 15 m and, under a sensor at 1.7 m, above 30 cm.
"""

import pathlib
import tempfile

import numpy as np
from numpy.typing import NDArray

import mosbench


def network(points: NDArray[np.float32]) -> NDArray[np.bool_]:
    moving: NDArray[np.bool_] = (points[:, 2] > -1.4) & (np.linalg.norm(points[:, :2], axis=1) < 15.0)
    return moving


def main(folder: pathlib.Path) -> None:
    data = mosbench.simulate(folder / "street", scene="street", scans=20)
    predictions = folder / "predictions"
    predictions.mkdir()
    counts = []
    for scan in mosbench.open(data, sequence="08"):
        moving = network(scan.points)
        counts.append(mosbench.confusion(moving, scan.truth, protocol="semantickitti-mos"))
        labels = np.where(moving, mosbench.MOVING_LABEL, mosbench.STATIC_LABEL)
        labels.astype(np.uint32).tofile(predictions / f"{scan.stem}.label")
    # The benchmark adds up the points of all scans; the mean of the scans' own IoU is another number.
    print("IoU", mosbench.pooled(counts, protocol="semantickitti-mos")["iou"])
    print("mean IoU of single scans", mosbench.mean_of_scans(counts))

    mine = mosbench.score(data, predictions, protocol="semantickitti-mos", method="my network", out=folder / "mine")
    theirs = mosbench.run(data, preset="semantickitti", out=folder / "hmm-mos")
    print(mine)
    print(theirs)
    difference = mosbench.stats(mine, theirs)["difference"]["iou"]["value"]
    print(f"HMM-MOS is better by {100 * difference:.1f} points of IoU")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        main(pathlib.Path(scratch))
