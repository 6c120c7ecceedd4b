#!/usr/bin/env python3
# %% [markdown]
# # Which method is best here?
# Runs methods on the same scans, ranks them, and asks where the best one errs.

# %%
import pathlib
import tempfile

import mosbench

scratch = tempfile.TemporaryDirectory()
work = pathlib.Path(scratch.name)
data = mosbench.simulate(work / "street", scene="street", scans=20)

# %% A method is one of mosbench, or a program of yours: method="exec:python3 my_network.py".
methods = ["hmm-mos", "hmm-mos-plus", "dynablox"]
results = {name: mosbench.run(data, method=name, out=work / name) for name in methods}
for name, result in results.items():
    print(f"{name}: IoU {result.iou:.3f}, precision {result.precision:.3f}, recall {result.recall:.3f}")

# %% Rank them. Twenty scans in a row tell too little for an interval, and the answer says so.
ranking = mosbench.rank(*results.values())
print(ranking["standing"])
best = max(methods, key=lambda name: results[name].iou or 0.0)
print("best:", best)
assert best == "hmm-mos-plus"

# %% Is it better by more than chance?
difference = mosbench.stats(results["hmm-mos"], results[best])["difference"]["iou"]
interval = difference["no_interval"] or f"95 % from {difference['low']:.3f} to {difference['high']:.3f}"
print(f"better by {100 * difference['value']:.1f} points; {interval}")

# %% How far does it see?
for row in mosbench.breakdown(data, results[best])["sequences"][0]["by_range"]:
    if row["iou"] is not None:
        print(f"{row['from_m']:.0f} m and farther: IoU {row['iou']:.3f}, {row['fn']} points missed")
