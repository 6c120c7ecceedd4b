"""Labels for data sets of scene flow."""

from __future__ import annotations

import os
import shutil
from typing import Any, Mapping, Optional, Union

import numpy as np

from mosbench.online import MOS, Config, Labels, SettingValue


def moving_for_h5(
    path: Union[str, os.PathLike[str]],
    config: Union[Config, Mapping[str, SettingValue], None] = None,
    *,
    threads: int = 1,
    overwrite: bool = False,
) -> int:
    """Fills the data set `dufo` (uint8 (N,), 1 moving) of every group of an .h5 file of OpenSceneFlow.

    config: as `MOS` takes it; "hmm-mos" with its defaults when not given, which `mosbench.Config()` prints.
    Groups are named by their stamp and hold `lidar` (N, 3 or more) and `pose` (4, 4). The file is replaced
    when all labels are there, and not before. Returns the number of scans. Raises ValueError for a file
    without these groups, or that has `dufo` already unless `overwrite`.
    """
    import h5py

    partial = f"{os.fspath(path)}.partial"
    with h5py.File(path, "r") as file:
        stamps = _stamps(file, os.fspath(path), overwrite)
    try:
        shutil.copyfile(path, partial)
        with h5py.File(partial, "r+") as file:
            _label(file, stamps, MOS(config, threads=threads, scan_count=len(stamps)))
        os.replace(partial, path)
    finally:
        if os.path.exists(partial):
            os.remove(partial)
    return len(stamps)


def _stamps(file: Any, path: str, overwrite: bool) -> list[str]:
    if not len(file):
        raise ValueError(f"{path}: holds no groups, expected one per scan, named by its stamp")
    for name, group in file.items():
        missing = [key for key in ("lidar", "pose") if not hasattr(group, "keys") or key not in group]
        if missing or not name.isdigit():
            wrong = f"has no {' and no '.join(missing)}" if missing else "is not named by a stamp"
            raise ValueError(f"{path}: group {name} {wrong}, expected groups of OpenSceneFlow")
        if "dufo" in group and not overwrite:
            raise ValueError(f"{path}: group {name} has dufo already, expected none, or overwrite=True")
    return sorted(file, key=int)


def _label(file: Any, stamps: list[str], mos: MOS) -> None:
    def write(results: list[Labels]) -> None:
        for result in results:
            group = file[stamps[result.index]]
            if "dufo" in group:
                del group["dufo"]
            group.create_dataset("dufo", data=result.moving.astype(np.uint8))

    for stamp in stamps:
        group = file[stamp]
        points = np.asarray(group["lidar"], dtype=np.float32)[:, :3]
        write(mos.push(points, np.asarray(group["pose"], dtype=np.float64)))
    write(mos.finish())
