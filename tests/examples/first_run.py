#!/usr/bin/env python3
# %% [markdown]
# # A first run
# Simulates a street, checks it, finds what moves, and looks at the worst scan.

# %%
import pathlib
import tempfile

import numpy as np

import mosbench

scratch = tempfile.TemporaryDirectory()  # a folder of yours keeps what is written
work = pathlib.Path(scratch.name)

# %% Make or name a data set, and ask whether it is sound.
data = mosbench.simulate(work / "street", scene="street", scans=20)
checkup = mosbench.doctor(data)
print("sound" if checkup else checkup)

# %% Segment it. The folder holds labels, and a later call goes on where an earlier one stopped.
result = mosbench.run(data, preset="best", out=work / "best")
print(result)
for warning in result.warnings:
    print("warning:", warning)

# %% Look at the scan with the most wrong points among those where it found something, and at its labels.
scans = result.per_scan[result.per_scan["moving"] > 0]
worst = scans[np.argmax(scans["fp"] + scans["fn"])]
labels = result["08"].labels(worst["stem"])
moving = int((labels == mosbench.MOVING_LABEL).sum())
print(f"worst scan {worst['stem']}: {moving} of {len(labels)} points are called moving, {worst['fn']} were missed")
assert moving == worst["moving"] > 0

# %% See it in 3-D: one file for any browser.
print(result.report(work / "street.html"))
