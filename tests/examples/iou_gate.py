#!/usr/bin/env python3
# %% [markdown]
# # A gate on IoU
# Fails when a change makes labels worse: for a test of yours, or as a step of CI.

# %%
import pathlib
import sys
import tempfile

import mosbench

scratch = tempfile.TemporaryDirectory()
work = pathlib.Path(scratch.name)
data = mosbench.simulate(work / "highway", scene="highway", scans=20)

# %% The baseline: a run that you keep, such as results/baseline. The change: the same with another setting.
baseline = mosbench.run(data, preset="semantickitti", out=work / "baseline")


def gate(**settings: float) -> mosbench.Comparison:
    """Compares a run with these settings with the baseline."""
    name = "_".join(f"{key}={value}" for key, value in settings.items()) or "same"
    config = mosbench.Config.preset("semantickitti").replace(**settings)
    run = mosbench.run(data, config=config, out=work / name)
    return mosbench.compare(baseline, run, max_drop=0.5, even_if=bool(settings))  # other settings are compared on demand


# %% What changes nothing passes. Voxels of 1 m lose objects, and are caught.
passed, caught = bool(gate()), not gate(voxel_size_m=1.0)
print(f"same settings pass: {passed}, coarse voxels are caught: {caught}")
sys.exit(0 if passed and caught else 1)
