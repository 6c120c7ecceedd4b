#!/usr/bin/env python3
"""sweep_p_min.py [PICTURE.svg]: runs a data set with several p_min and plots precision and recall."""

import pathlib
import sys
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import mosbench


def main(folder: pathlib.Path, picture: pathlib.Path) -> None:
    data = mosbench.simulate(folder / "street", scene="street", scans=20)
    near = mosbench.Config.preset("semantickitti").replace(max_range_m=30.0, min_otsu_score=1)
    values = [0.5, 0.7, 0.9, 0.99]
    results = [
        mosbench.run(data, config=near.replace(min_state_probability=value), out=folder / f"p_min_{value}") for value in values
    ]
    for value, result in zip(values, results):
        print(f"p_min {value}: IoU {result.iou:.3f}")
    figure, axes = plt.subplots()
    for metric in ("iou", "precision", "recall"):
        axes.plot(values, [result.metrics[metric] for result in results], marker="o", label=metric)
    axes.set_xlabel("p_min")
    axes.legend()
    figure.savefig(picture)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        main(pathlib.Path(scratch), pathlib.Path(*sys.argv[1:2] or [scratch, "p_min.svg"]))
