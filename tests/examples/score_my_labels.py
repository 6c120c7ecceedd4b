#!/usr/bin/env python3
# %% [markdown]
# # The labels of a network of yours
# Scores them by a benchmark's rules, in Python and by the program, and compares them with a method.

# %%
import pathlib
import tempfile

import numpy as np
from numpy.typing import NDArray

import mosbench

scratch = tempfile.TemporaryDirectory()
work = pathlib.Path(scratch.name)
data = mosbench.simulate(work / "street", scene="street", scans=20)


# %% Put your network here. This one calls moving what is near and, under a sensor at 1.7 m, above 30 cm.
def network(points: NDArray[np.float32]) -> NDArray[np.bool_]:
    moving: NDArray[np.bool_] = (points[:, 2] > -1.4) & (np.linalg.norm(points[:, :2], axis=1) < 15.0)
    return moving


# %% Count scan by scan, and write the labels as files, as any program may.
predictions = work / "predictions"
predictions.mkdir()
counts = []
for scan in mosbench.open(data, sequence="08"):
    moving = network(scan.points)
    counts.append(mosbench.confusion(moving, scan.truth, protocol="semantickitti-mos"))
    labels = np.where(moving, mosbench.MOVING_LABEL, mosbench.STATIC_LABEL)
    labels.astype(np.uint32).tofile(predictions / f"{scan.stem}.label")

# %% The benchmark adds up the points of all scans; the mean of the scans' own IoU is another number.
pooled = mosbench.pooled(counts, protocol="semantickitti-mos")["iou"]
print("IoU", pooled)
print("mean IoU of single scans", mosbench.mean_of_scans(counts))

# %% Score the files, and compare with a method on the same scans.
mine = mosbench.score(data, predictions, protocol="semantickitti-mos", method="my network", out=work / "mine")
theirs = mosbench.run(data, preset="semantickitti", out=work / "hmm-mos")
print(mine)
print(theirs)
assert mine.iou == pooled
difference = mosbench.stats(mine, theirs)["difference"]["iou"]["value"]
print(f"HMM-MOS is better by {100 * difference:.1f} points of IoU")
