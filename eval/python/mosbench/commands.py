"""The commands of the program, in this process."""

from __future__ import annotations

import contextlib
import dataclasses
import json
import os
import pathlib
import shutil
import tempfile
from typing import Any, Iterable, Iterator, Mapping, Optional, Union

import numpy as np

from mosbench import _mosbench
from mosbench.arrays import Array, as_array
from mosbench.datasets import Dataset, Opened, Sequence, seconds_after_stamp
from mosbench.flags import flags, plain_errors, reading_flags, whole_number
from mosbench.online import Config, SettingValue, refuse_no_settings
from mosbench.poses import checked_poses, is_path, keep_poses, pose_files, write_changed
from mosbench.results import Result

PathLike = Union[str, os.PathLike[str]]


def _command(arguments: list[str], quiet: bool = True) -> tuple[int, str]:
    return plain_errors(_mosbench.command, arguments, quiet)


def _json(text: str) -> dict[str, Any]:
    content: dict[str, Any] = json.loads(text)
    return content


def _answer(arguments: list[str], quiet: bool = True) -> tuple[int, dict[str, Any]]:
    exit_code, text = _command([*arguments, "--json"], quiet)
    return exit_code, _json(text)


def _setting_flags(settings: Optional[Mapping[str, SettingValue]], flag: str = "--set") -> list[str]:
    return [f"{flag}={name}={value!r}" if isinstance(value, float) else f"{flag}={name}={value}"
            for name, value in (settings or {}).items()]  # fmt: skip


def _odometry_words(
    kind: Optional[str], preset: Optional[str], settings: Optional[Mapping[str, SettingValue]], drop_moving: bool
) -> Optional[str]:
    """Returns the value of --odometry: KIND:PRESET,KEY=VALUE,..."""
    chosen = (kind or "") + (f":{preset}" if preset else "")
    parts = [chosen, *(flag.removeprefix("--set=") for flag in _setting_flags(settings))]
    return ",".join(part for part in [*parts, "drop_moving=on" if drop_moving else ""] if part) or None


def _how_to_read(data: Any, reading: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the reading of what `mosbench.open` opened, with what is given now over it."""
    opened: Mapping[str, Any] = data.opened_by.reading if isinstance(data, (Dataset, Sequence)) else {}
    return {**opened, **reading}


def _refuse_no_poses(reading: Mapping[str, Any]) -> None:
    if isinstance(reading.get("poses"), bool):
        raise ValueError(f"poses: is {reading['poses']}, expected poses of the scans: a file, (K, 4, 4), None for the "
                         "data set's own, or of run odometry='simple', which finds them from the scans")


def _names(names: Union[str, Iterable[str]]) -> Optional[list[str]]:
    return ([names] if isinstance(names, str) else list(names)) or None


def _data_flags(data: Any, dataset: str, sequences: Iterable[str], reading: Mapping[str, Any]) -> list[str]:
    """Returns the folder of data, or of what `mosbench.open` opened, and how to read it."""
    names: Optional[Iterable[str]] = _names(sequences)
    if isinstance(data, (Dataset, Sequence)):
        by: Opened = data.opened_by
        data, dataset, names = by.path, by.dataset, names or by.sequences
    return [os.fspath(data), *flags(dataset=dataset, sequences=list(names) if names else None), *reading_flags(reading)]


def _answer_on_data(
    command: str, data: Any, dataset: str, sequences: Iterable[str], reading: Mapping[str, Any], more: list[str]
) -> tuple[int, dict[str, Any]]:
    """Answers a command that needs poses and keeps no results."""
    reading = _how_to_read(data, reading)
    _refuse_no_poses(reading)
    with pose_files() as files:
        return _answer([command, *_data_flags(data, dataset, sequences, files.reading(reading)), *more])


def _folder(result: Union[Result, PathLike]) -> str:
    return os.fspath(result.folder if isinstance(result, Result) else result)


def _data_folder(out: PathLike) -> pathlib.Path:
    """Returns <out>-data, for what results in `out` are of and no file had."""
    out = pathlib.Path(out)
    return out.with_name(out.name + "-data")


@contextlib.contextmanager
def _removed_on_error(folder: Optional[pathlib.Path]) -> Iterator[None]:
    """Removes a folder that a failed call made; what Ctrl-C ends goes on from there."""
    made = folder if folder is not None and not folder.exists() else None
    try:
        yield
    except Exception:
        if made is not None:
            shutil.rmtree(made, ignore_errors=True)
        raise


def _points_of(item: Any, index: int) -> Array:
    points = as_array((item or (None,))[0] if isinstance(item, tuple) else item, f"scan {index}")
    if points.dtype.kind not in "fiu":
        raise ValueError(f"scan {index}: is {type(item).__name__} without points, expected (points (N, 3), times)")
    if points.ndim != 2 or points.shape[1] < 3:
        raise ValueError(f"scan {index}: has shape {points.shape}, expected (N, 3) or more columns")
    return points.astype(np.float32, copy=False)


def _scan_rows(item: Any, index: int, with_times: bool) -> bytes:
    """Returns a scan of KISS-ICP's data sets as a .bin file, with times as one with five columns."""
    points = _points_of(item, index)
    rows = np.zeros((len(points), 5 if with_times else 4), dtype="<f4")
    rows[:, : min(4, points.shape[1])] = points[:, :4]
    if with_times:
        times = item[1] if isinstance(item, tuple) and len(item) > 1 else ()
        times_s = seconds_after_stamp(times, len(points), index)
        if times_s is None and len(points) > 0:
            raise ValueError(f"scan {index}: has no times of points, expected them with deskew=")
        rows[:, 4] = () if times_s is None else times_s
    return rows.tobytes()


def _gt_poses(dataset: Any) -> Array:
    poses = getattr(dataset, "gt_poses", None)
    if poses is None:
        raise ValueError("data: has no gt_poses, one (4, 4) per scan; expected them, or odometry='simple'")
    if len(poses) != len(dataset):
        raise ValueError(f"data: has {len(poses)} gt_poses for {len(dataset)} scans, expected one (4, 4) per scan")
    return checked_poses(poses, "gt_poses")


def _claim(folder: pathlib.Path, dataset: Any) -> None:
    """Makes the folder of scans. Raises ValueError when it has those of objects of another class."""
    owner, mark = type(dataset).__qualname__, folder / "class.txt"
    folder.mkdir(parents=True, exist_ok=True)
    if mark.exists() and (before := mark.read_text().strip()) != owner:
        raise ValueError(f"out: {folder} has scans of {before}, expected those of {owner}: give each an out of its own")
    mark.write_text(owner + "\n")


def _write_sequence(dataset: Any, folder: pathlib.Path, with_poses: bool, with_times: bool) -> None:
    """Writes what KISS-ICP takes for a data set: (points, times) by index, `gt_poses`."""
    poses = _gt_poses(dataset) if with_poses else None
    _claim(folder.parent, dataset)
    (folder / "velodyne").mkdir(parents=True, exist_ok=True)
    for stale in sorted((folder / "velodyne").glob("[0-9]*.bin"))[len(dataset) :]:
        stale.unlink()  # of a longer data set that was written here before
    for index in range(len(dataset)):
        rows = _scan_rows(dataset[index], index, with_times)
        write_changed(folder / "velodyne" / f"{index:06d}.bin", rows)
    if poses is not None:
        keep_poses(folder / "poses.txt", poses, "gt_poses")


def _with_kept_poses(reading: Mapping[str, Any], out: Optional[PathLike]) -> dict[str, Any]:
    """Returns how to read data with <out>-data/poses.txt where poses are an array: a report reads them again."""
    poses = reading.get("poses")
    if poses is None or is_path(poses):
        return dict(reading)
    if out is None:
        raise ValueError("out: is not given, expected a folder, beside which poses in an array are kept")
    poses = checked_poses(poses, "poses")
    file = _data_folder(out) / "poses.txt"
    file.parent.mkdir(parents=True, exist_ok=True)
    keep_poses(file, poses, "poses")
    return {**reading, "poses": file}


def run(
    data: Any,
    preset: Optional[str] = None,
    out: Optional[PathLike] = None,
    *,
    config: Union[Config, Mapping[str, SettingValue], None] = None,
    method: Optional[str] = None,
    moving: Optional[str] = None,
    dataset: str = "auto",
    sequences: Iterable[str] = (),
    protocol: Optional[str] = None,
    odometry: Optional[str] = None,
    odometry_preset: Optional[str] = None,
    odometry_settings: Optional[Mapping[str, SettingValue]] = None,
    drop_moving: bool = False,
    scores: bool = False,
    write: Union[str, Iterable[str]] = (),
    overwrite: bool = False,
    threads: Optional[int] = None,
    progress: bool = False,
    **reading: Any,
) -> Result:
    """Segments a data set and scores it, as `mosbench run` does; an interrupted run goes on.

    data: a folder, what `mosbench.open` returned, or an object with `len`, `[i] -> (points (N, 3), times)`
    and `gt_poses`, as KISS-ICP takes data sets; its scans are written to a folder in `<out>-data`, with
    deskew="velocity" or "poses" also the times. Objects of one class may share `out`, by their `sequence_id`.
    out: folder of the results; results/runs/... when not given.
    config: a Config is all settings of its method, and given without preset. Settings by name are set over
    those of `preset`, and without one over the preset of the data set, or the method's defaults.
    moving: "ever" or "ever:3" of hmm-mos-plus: whatever moved in the last 10, or 3, seconds, as `run --moving`.
    odometry: "simple" or "kiss" finds the poses from the scans instead of reading them.
    write: "boxes", "moving-cloud", "static-cloud", "static-cloud-pcd", one or several: files beside the labels, as
    `run --write` adds.
    progress: print progress and notes on stderr.
    reading: `poses`, `pose_frame`, ... as mosbench.READING lists them; poses in an array are kept in `<out>-data`.
    """
    refuse_no_settings(config)
    if isinstance(config, Config):
        if preset is not None:
            raise ValueError(f"preset: is given beside a Config, which replaces all settings of {preset}; expected "
                             f"config=Config.preset({preset!r}).replace(...), or a dict of what differs")
        if method not in (None, config.method):
            raise ValueError(f"method: is {method}, expected {config.method} as config has it")
        method, config = config.method, config.to_dict()
    if method and _mosbench.names_several_methods(method):
        raise ValueError(f"method: '{method}' names several, expected one; each gives a Result of its own")
    reading = _how_to_read(data, reading)
    if odometry is None:
        _refuse_no_poses(reading)
    elif reading.get("poses") is False:
        reading["poses"] = None
    is_object = not isinstance(data, (str, os.PathLike, Dataset, Sequence))
    name = str(getattr(data, "sequence_id", type(data).__name__)).replace("/", "_")
    if is_object and out is None:
        out = f"results/runs/{name}"
    with _removed_on_error(None if out is None else _data_folder(out)):
        if is_object and out is not None:
            folder = _data_folder(out) / name
            with_times = reading.get("deskew") in ("velocity", "poses") and "point_times" not in reading
            _write_sequence(data, folder, odometry is None and reading.get("poses") is None, with_times)
            if with_times:
                reading |= {"point_times": "column", "bin_columns": 5}
            data = folder
        arguments = ["run", *_data_flags(data, dataset, sequences, _with_kept_poses(reading, out))]
        written = [*(["scores"] if scores else []), *(_names(write) or [])]
        arguments += flags(preset=preset, out=out, method=method, protocol=protocol, write=written or None)
        arguments += flags(overwrite=overwrite, threads=threads)
        arguments += flags(odometry=_odometry_words(odometry, odometry_preset, odometry_settings, drop_moving))
        arguments += _setting_flags(None if moving is None else {"moving": moving})
        _, answer = _answer(arguments + _setting_flags(config), quiet=not progress)
    return Result(answer["out"])


def score(
    data: Any,
    predictions: Union[Result, PathLike],
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
    overwrite: bool = False,
    threads: Optional[int] = None,
    **reading: Any,
) -> Result:
    """Scores the predictions of any method, as `mosbench score` does.

    predictions: a folder or file, or a Result; for labels in arrays there is `mosbench.metrics`.
    out: folder to keep the results in; without it they are dropped after they are read.
    overwrite: replace other scores there.
    data, reading: as for `run`.
    """
    if not isinstance(predictions, (Result, str, os.PathLike)):
        raise TypeError(f"predictions: is {type(predictions).__name__}, expected a folder or file, or a Result; "
                        "mosbench.metrics takes arrays")
    if protocol == "all":
        raise ValueError(f"protocol: is 'all', expected one: {', '.join(_mosbench.protocol_names())}")
    reading = _how_to_read(data, reading)
    if reading.get("poses") is False:
        reading["poses"] = None  # no score depends on them
    with tempfile.TemporaryDirectory() as scratch:
        kept = pathlib.Path(out) if out is not None else pathlib.Path(scratch) / "score"
        arguments = flags(predictions=_folder(predictions), protocol=protocol, out=kept, format=format)
        arguments += flags(id_map=id_map, split=split, method=method, allow_missing=allow_missing, threads=threads)
        arguments += flags(overwrite=overwrite)
        with _removed_on_error(_data_folder(kept)):
            _answer(["score", *_data_flags(data, dataset, sequences, _with_kept_poses(reading, kept)), *arguments])
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
    """Returns where predictions are right and wrong: as `stats --by range,height,object --json`."""
    more = flags(by="range,height,object", predictions=_folder(predictions), protocol=protocol, top=top)
    return _answer_on_data("stats", data, dataset, sequences, reading, more)[1]


def diff(
    first: Union[Result, PathLike], second: Union[Result, PathLike], *, top: Optional[int] = None
) -> dict[str, Any]:
    """Returns the scans on which two runs disagree, as `compare --by scan,object --json` has it."""
    return _answer(["compare", _folder(first), _folder(second), *flags(by="scan,object", top=top)])[1]


def table(name: str, *results: Union[Result, PathLike]) -> dict[str, Any]:
    """Returns a published table ("I", "II", ...) with measured values next to it, as `table --json`."""
    return _json(_command(["table", name, *map(_folder, results), "--json"])[1])


def rank(*results: Union[Result, PathLike], order: str = "iou") -> dict[str, Any]:
    """Returns runs by sequences with intervals and what is not beaten, as `rank --json`.

    order: "iou", the best first, or "given"; differences are to the first row.
    """
    return _json(_command(["rank", *map(_folder, results), *flags(order=order), "--json"])[1])


def curve(result: Union[Result, PathLike], picture: Optional[PathLike] = None) -> dict[str, Any]:
    """Returns precision and recall by the threshold of scores, as `stats --by threshold --json`.

    result: of `run(..., scores=True)`. picture: PNG file to draw the curve to.
    """
    return _json(_command(["stats", _folder(result), *flags(by="threshold", out=picture), "--json"])[1])


def map_score(map: PathLike, truth: PathLike, *, same_within_m: float = 0.05) -> dict[str, Any]:
    """Returns SA, DA, AA and HA (0 to 1) of a map that was cleaned of what moved, as `score --map --json`.

    map: .pcd or .ply file. truth: the points that it was made of, with intensity 1 where they are dynamic, or the
    folder of a sequence of KTH's DynamicMap_Benchmark. same_within_m: how near a point of the map stands for one of
    the truth.
    """
    arguments = ["score", os.fspath(truth), *flags(map=map, same_within_m=same_within_m)]
    return _json(_command([*arguments, "--json"])[1])


@dataclasses.dataclass(frozen=True)
class Comparison:
    """What comparing two runs found; true when it is ok."""

    ok: bool  #: no sequence lost more than it may
    content: dict[str, Any] = dataclasses.field(repr=False)  #: as `compare --json` has it

    def __bool__(self) -> bool:
        return self.ok


def compare(
    baseline: Union[Result, PathLike],
    new: Union[Result, PathLike],
    *,
    max_drop: Optional[float] = None,
    statistical: bool = False,
    even_if: bool = False,
    max_cost: Optional[Mapping[str, float]] = None,
    sequences: Iterable[str] = (),
    method: Optional[str] = None,
) -> Comparison:
    """Judges whether IoU dropped, as `mosbench compare` does.

    max_drop: in percentage points. even_if: also compare results of different kinds. max_cost: in percent, by how
    much "cpu", "memory" and "bytes" may grow; without it such growth is in `content` alone. sequences, method: to
    look at these only, where the folders hold more.
    """
    arguments = ["compare", _folder(baseline), _folder(new)]
    arguments += flags(max_drop=max_drop, statistical=statistical, even_if=even_if, sequences=_names(sequences))
    cost = [f"{kind}={percent}" for kind, percent in (max_cost or {}).items()]
    exit_code, content = _answer(arguments + flags(max_cost=cost or None, method=method))
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
    scans, seed = whole_number(scans, "scans", 1), whole_number(seed, "seed", 0)
    arguments = ["simulate", *flags(out=out, layout=layout, scene=scene, scans=scans, seed=seed, perturb=perturb)]
    _command(arguments)
    return pathlib.Path(out)


def stats(first: Union[Result, PathLike], second: Union[Result, PathLike, None] = None) -> dict[str, Any]:
    """Returns metrics with 95 % intervals, of two runs the paired difference, as `stats --json` has it."""
    return _answer(["stats", *(_folder(one) for one in (first, second) if one is not None)])[1]


@dataclasses.dataclass(frozen=True)
class Checkup:
    """What the doctor found; true when it is ok."""

    ok: bool  #: nothing is wrong
    content: dict[str, Any] = dataclasses.field(repr=False)  #: as `doctor --json` has it

    def __bool__(self) -> bool:
        return self.ok

    @property
    def symptoms(self) -> list[dict[str, Any]]:
        """Severity, place and sentence of everything that is wrong."""
        symptoms: list[dict[str, Any]] = self.content["symptoms"]
        return symptoms


def doctor(data: Any, *, dataset: str = "auto", sequences: Iterable[str] = (), **reading: Any) -> Checkup:
    """Checks a data set before anything is run on it; data and reading as for `run`."""
    exit_code, content = _answer_on_data("doctor", data, dataset, sequences, reading, [])
    return Checkup(exit_code == 0, content)


def evaluate_trajectory(estimate: Any, truth: Any, *, align: str = "none") -> dict[str, Any]:
    """Returns KITTI's errors, APE and RPE of poses, as `trajectory --json`.

    estimate, truth: files, or arrays (K, 4, 4), metres, map_from_sensor.
    align: "none", "origin", "rigid" or "similarity".
    KITTI's errors are the devkit's to every digit, and so of numbers in float32: an error of rotation under
    about 0.02 degrees may round to 0 there, or to that; APE and RPE are of float64.
    """
    with pose_files() as files:
        arguments = ["trajectory", files.path(estimate, "estimate")]
        arguments += [*flags(truth=files.path(truth, "truth"), align=align), "--json"]
        return _json(files.named(_command(arguments)[1]))
