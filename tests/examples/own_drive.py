#!/usr/bin/env python3
# %% [markdown]
# # A drive of your own
# A folder of scans is enough: poses are found, then what moves. Here the scans are simulated, so that both can be judged.

# %%
import pathlib
import shutil
import tempfile

import mosbench

scratch = tempfile.TemporaryDirectory()
work = pathlib.Path(scratch.name)
street = mosbench.open(mosbench.simulate(work / "street", scene="street", scans=20), sequence="08")
drive = work / "drive"  # yours: a bag, or a folder of .bin, .pcd or .ply files
shutil.copytree(next((work / "street").rglob("velodyne")), drive / "velodyne")

# %% Find the poses, keep them, and see how good they are. Yours have no truth: `doctor` says how well scans fit.
poses = mosbench.odometry(mosbench.open(drive, poses=False), kind="simple", min_range_m=1.5)
mosbench.write_poses(work / "poses.txt", poses)
errors = mosbench.evaluate_trajectory(poses, street.gt_poses, align="origin")
off_m = errors["sequences"][0]["absolute"]["translation_m"]["rmse"]
print(f"the poses are {off_m:.3f} m off")
assert off_m < 0.1

# %% Segment with these poses; `odometry="simple"` does both at once. A map of what stands still comes with it.
result = mosbench.run(drive, poses=work / "poses.txt", preset="best", write="static-cloud", out=work / "run")
print(f"{result.per_scan['moving'].sum()} points move; map: {next(result.folder.rglob('static.ply'))}")

# %% Score the labels, where there is truth.
scored = mosbench.score(street, result.folder / "drive/labels", protocol="semantickitti-mos", out=work / "scored")
print(f"IoU with these poses: {scored.iou:.3f}")
assert scored.iou is not None and scored.iou > 0.5
