"""The commands of the program, in this process."""

from __future__ import annotations

import dataclasses
import io
import json
import os
import pathlib
import tempfile
from typing import Any, Iterable, Mapping, Optional, Union

import numpy as np

from mosbench import _mosbench
from mosbench.arrays import as_array
from mosbench.datasets import Dataset, Opened, Sequence, seconds_after_stamp
from mosbench.flags import flags, plain_errors, reading_flags
from mosbench.online import Config, SettingValue
from mosbench.results import Result

PathLike = Union[str, os.PathLike]


def _command(arguments: list[str], quiet: bool = True) -> tuple[int, str]:
    return plain_errors(_mosbench.command, arguments, quiet)


def _answer(arguments: list[str], quiet: bool = True) -> tuple[int, Any]:
    exit_code, text = _command([*arguments, "--json"], quiet)
    return exit_code, json.loads(text)


def _setting_flags(settings: Optional[Mapping[str, SettingValue]], flag: str = "--set") -> list[str]:
    return [f"{flag}={name}={value!r}" if isinstance(value, float) else f"{flag}={name}={value}"
            for name, value in (settings or {}).items()]  # fmt: skip


def _data_flags(data: Any, dataset: str, sequences: Iterable[str], reading: Mapping[str, Any]) -> list[str]:
    """Returns the folder of data, or of what `mosbench.open` opened, and how to read it."""
    names = [sequences] if isinstance(sequences, str) else list(sequences)
    if isinstance(data, (Dataset, Sequence)):
        by: Opened = data.opened_by
        data, dataset, names, reading = by.path, by.dataset, names or by.sequences, {**by.reading, **reading}
    return [os.fspath(data), *flags(dataset=dataset, sequences=names or None), *reading_flags(reading)]


def _folder(result: Union[Result, PathLike]) -> str:
    return os.fspath(result.folder if isinstance(result, Result) else result)


def _write_changed(file: pathlib.Path, content: bytes) -> None:
    """Leaves a file alone that has the content already, so that finished runs over it stay finished."""
    if not file.exists() or file.read_bytes() != content:
        file.write_bytes(content)


def _pose_rows(poses: np.ndarray) -> bytes:
    """Returns KITTI's rows of poses (K, 4, 4)."""
    rows = io.BytesIO()
    np.savetxt(rows, poses[:, :3].reshape(-1, 12), fmt="%.17g")
    return rows.getvalue()


def _scan_rows(item: Any, index: int, with_times: bool) -> bytes:
    """Returns a scan of KISS-ICP's data sets as a .bin file, with times as one with five columns."""
    points = np.asarray(item[0] if isinstance(item, tuple) else item, dtype=np.float32)
    if points.ndim != 2 or points.shape[1] < 3:
        raise ValueError(f"scan {index}: has shape {points.shape}, expected (N, 3) or more columns")
    rows = np.zeros((len(points), 5 if with_times else 4), dtype="<f4")
    rows[:, : min(4, points.shape[1])] = points[:, :4]
    if with_times:
        times_s = seconds_after_stamp(item[1] if isinstance(item, tuple) else (), len(points), index)
        if times_s is None and len(points) > 0:
            raise ValueError(f"scan {index}: has no times of points, expected them with deskew=")
        rows[:, 4] = () if times_s is None else times_s
    return rows.tobytes()


def _write_sequence(dataset: Any, folder: pathlib.Path, with_poses: bool, with_times: bool) -> None:
    """Writes what KISS-ICP takes for a data set: (points, times) by index, `gt_poses`."""
    (folder / "velodyne").mkdir(parents=True, exist_ok=True)
    for stale in sorted((folder / "velodyne").glob("[0-9]*.bin"))[len(dataset) :]:
        stale.unlink()  # of a longer data set that was written here before
    for index in range(len(dataset)):
        rows = _scan_rows(dataset[index], index, with_times)
        _write_changed(folder / "velodyne" / f"{index:06d}.bin", rows)
    if not with_poses:
        return
    poses = getattr(dataset, "gt_poses", None)
    if poses is None or len(poses) != len(dataset):
        raise ValueError("data: has no gt_poses, one (4, 4) per scan; expected them, or odometry='simple'")
    _write_changed(folder / "poses.txt", _pose_rows(np.asarray(poses, dtype=np.float64)))


def run(
    data: Any,
    preset: Optional[str] = None,
    out: Optional[PathLike] = None,
    *,
    config: Union[Config, Mapping[str, SettingValue], None] = None,
    method: Optional[str] = None,
    dataset: str = "auto",
    sequences: Iterable[str] = (),
    protocol: Optional[str] = None,
    odometry: Optional[str] = None,
    odometry_preset: Optional[str] = None,
    odometry_settings: Optional[Mapping[str, SettingValue]] = None,
    drop_moving: bool = False,
    scores: bool = False,
    overwrite: bool = False,
    threads: Optional[int] = None,
    progress: bool = False,
    **reading: Any,
) -> Result:
    """Segments a data set and scores it, as `mosbench run` does; an interrupted run goes on.

    data: a folder, what `mosbench.open` returned, or an object with `len`, `[i] -> (points (N, 3), times)`
    and `gt_poses`, as KISS-ICP takes data sets; its scans are written to a folder in `<out>-data`, with
    deskew="velocity" or "poses" also the times.
    out: folder of the results; results/runs/... when not given.
    odometry: "simple" or "kiss" finds the poses from the scans instead of reading them.
    progress: print progress and notes on stderr.
    reading: `poses`, `pose_frame`, ... as mosbench.READING lists them.
    """
    if isinstance(config, Config):
        if method not in (None, config.method):
            raise ValueError(f"method: is {method}, expected {config.method} as config has it")
        method, config = config.method, config.to_dict()
    if method and _mosbench.names_several_methods(method):
        raise ValueError(f"method: '{method}' names several, expected one; each gives a Result of its own")
    if not isinstance(data, (str, os.PathLike, Dataset, Sequence)):
        name = str(getattr(data, "sequence_id", type(data).__name__)).replace("/", "_")
        out = pathlib.Path(out or f"results/runs/{name}")
        folder = out.with_name(out.name + "-data") / name
        with_poses = odometry is None and reading.get("poses") is None
        with_times = reading.get("deskew") in ("velocity", "poses") and "point_times" not in reading
        _write_sequence(data, folder, with_poses, with_times)
        if with_times:
            reading |= {"point_times": "column", "bin_columns": 5}
        data = folder
    arguments = ["run", *_data_flags(data, dataset, sequences, reading)]
    arguments += flags(preset=preset, out=out, method=method, protocol=protocol, scores=scores)
    arguments += flags(overwrite=overwrite, threads=threads, drop_moving=drop_moving)
    arguments += flags(odometry=odometry, odometry_preset=odometry_preset)
    arguments += _setting_flags(odometry_settings, "--odometry-set")
    _, answer = _answer(arguments + _setting_flags(config), quiet=not progress)
    return Result(answer["out"])


def score(
    data: Any,
    predictions: PathLike,
    protocol: Optional[str] = None,
    out: Optional[PathLike] = None,
    *,
    dataset: str = "auto",
    sequences: Iterable[str] = (),
    format: Optional[str] = None,
    id_map: Optional[str] = None,
    split: Optional[str] = None,
    method: Optional[str] = None,
    allow_missing: bool = False,
    threads: Optional[int] = None,
    **reading: Any,
) -> Result:
    """Scores the predictions of any method, as `mosbench score` does.

    out: folder to keep the results in; without it they are dropped after they are read.
    data, reading: as for `run`.
    """
    with tempfile.TemporaryDirectory() as scratch:
        kept = pathlib.Path(out) if out is not None else pathlib.Path(scratch) / "score"
        arguments = ["score", *_data_flags(data, dataset, sequences, reading)]
        arguments += flags(predictions=predictions, protocol=protocol, out=kept, format=format)
        arguments += flags(id_map=id_map, split=split, method=method, allow_missing=allow_missing)
        _answer(arguments + flags(threads=threads))
        return Result(kept)


def breakdown(
    data: Any,
    predictions: Union[Result, PathLike],
    protocol: Optional[str] = None,
    *,
    top: Optional[int] = None,
    dataset: str = "auto",
    sequences: Iterable[str] = (),
    **reading: Any,
) -> dict[str, Any]:
    """Returns where predictions are right and wrong: by range, size and speed, as `breakdown --json` has it."""
    arguments = ["breakdown", *_data_flags(data, dataset, sequences, reading)]
    return _answer(arguments + flags(predictions=_folder(predictions), protocol=protocol, top=top))[1]


def diff(
    first: Union[Result, PathLike], second: Union[Result, PathLike], *, top: Optional[int] = None
) -> dict[str, Any]:
    """Returns the scans on which two runs disagree, as `diff --json` has it."""
    return _answer(["diff", _folder(first), _folder(second), *flags(top=top)])[1]


def table(name: str, *results: Union[Result, PathLike]) -> dict[str, Any]:
    """Returns a published table ("I", "II", ...) with measured values next to it, as `table --format json`."""
    return json.loads(_command(["table", name, *map(_folder, results), "--format=json"])[1])


def rank(*results: Union[Result, PathLike], order: str = "iou") -> dict[str, Any]:
    """Returns runs by sequences with intervals and what is not beaten, as `rank --format json`.

    order: "iou", the best first, or "given"; differences are to the first row.
    """
    return json.loads(_command(["rank", *map(_folder, results), *flags(order=order), "--format=json"])[1])


def curve(result: Union[Result, PathLike], picture: Optional[PathLike] = None) -> dict[str, Any]:
    """Returns precision and recall by the threshold of scores, as `curve --format json`.

    result: of `run(..., scores=True)`. picture: PNG file to draw the curve to.
    """
    return json.loads(_command(["curve", _folder(result), *flags(out=picture), "--format=json"])[1])


@dataclasses.dataclass(frozen=True)
class Comparison:
    """What comparing two runs found."""

    ok: bool  #: no sequence lost more than it may
    content: dict[str, Any] = dataclasses.field(repr=False)  #: as `compare --json` has it


def compare(
    baseline: Union[Result, PathLike],
    new: Union[Result, PathLike],
    *,
    max_drop: Optional[float] = None,
    statistical: bool = False,
    even_if: bool = False,
) -> Comparison:
    """Judges whether IoU dropped, as `mosbench compare` does.

    max_drop: in percentage points. even_if: also compare results of different kinds.
    """
    arguments = ["compare", _folder(baseline), _folder(new)]
    exit_code, content = _answer(arguments + flags(max_drop=max_drop, statistical=statistical, even_if=even_if))
    return Comparison(exit_code == 0, content)


def simulate(
    out: PathLike,
    layout: str = "semantickitti",
    scene: str = "street",
    scans: int = 60,
    seed: int = 1,
    perturb: Optional[str] = None,
) -> pathlib.Path:
    """Writes a simulated data set with exact truth and returns its folder.

    perturb: "KIND=STRENGTH,...,seed=N", disturbances as `mosbench list perturbations` has them.
    """
    arguments = ["simulate", *flags(out=out, layout=layout, scene=scene, scans=scans, seed=seed, perturb=perturb)]
    _command(arguments)
    return pathlib.Path(out)


def stats(first: Union[Result, PathLike], second: Union[Result, PathLike, None] = None) -> dict[str, Any]:
    """Returns metrics with 95 % intervals, of two runs the paired difference, as `stats --json` has it."""
    return _answer(["stats", *(_folder(one) for one in (first, second) if one is not None)])[1]


@dataclasses.dataclass(frozen=True)
class Checkup:
    """What the doctor found."""

    ok: bool  #: nothing is wrong
    content: dict[str, Any] = dataclasses.field(repr=False)  #: as `doctor --json` has it

    @property
    def symptoms(self) -> list[dict[str, Any]]:
        """Severity, place and sentence of everything that is wrong."""
        return self.content["symptoms"]


def doctor(data: Any, *, dataset: str = "auto", sequences: Iterable[str] = (), **reading: Any) -> Checkup:
    """Checks a data set before anything is run on it; data and reading as for `run`."""
    exit_code, content = _answer(["doctor", *_data_flags(data, dataset, sequences, reading)])
    return Checkup(exit_code == 0, content)


def _pose_file(poses: Any, folder: str, name: str) -> str:
    if isinstance(poses, (str, os.PathLike)):
        return os.fspath(poses)
    matrices = as_array(poses)
    if matrices.ndim != 3 or matrices.shape[1:] != (4, 4):
        raise ValueError(f"{name}: has shape {matrices.shape}, expected (K, 4, 4)")
    file = pathlib.Path(folder, f"{name}.txt")
    file.write_bytes(_pose_rows(matrices))
    return os.fspath(file)


def evaluate_trajectory(estimate: Any, truth: Any, *, align: str = "none") -> dict[str, Any]:
    """Returns KITTI's errors, APE and RPE of poses (files, or arrays (K, 4, 4)), as `trajectory --json`.

    align: "none", "origin", "rigid" or "similarity".
    """
    with tempfile.TemporaryDirectory() as folder:
        arguments = ["trajectory", _pose_file(estimate, folder, "estimate")]
        arguments += flags(truth=_pose_file(truth, folder, "truth"), align=align)
        return _answer(arguments)[1]
