"""Methods and odometry, scan by scan."""

from __future__ import annotations

import collections.abc
import copy
import dataclasses
import os
from typing import Any, Iterable, Iterator, Mapping, Optional, Union

import numpy as np

from mosbench import _mosbench
from mosbench.arrays import Array, as_array
from mosbench.datasets import Scan, open as open_data
from mosbench.datasets import seconds_after_stamp
from mosbench.flags import plain_errors, whole_number

SettingValue = Union[int, float, str]
MOST_THREADS = 1024


def _set(settings: _mosbench.Settings, values: Mapping[str, SettingValue]) -> None:
    for name, value in values.items():
        value = value.item() if isinstance(value, np.generic) else value
        if not isinstance(value, (int, float, str)):
            raise TypeError(f"{name}: is {value!r}, expected a number or a name")
        settings.set(name, value)


class Config(collections.abc.Mapping[str, SettingValue]):
    """A method and its settings, a mapping of them. They carry their unit in their name, as in `voxel_size_m`."""

    def __init__(self, method: str = "hmm-mos", **settings: SettingValue):
        """Takes the method's defaults with these settings over them."""
        self._method = method
        self._preset: Optional[str] = None
        self._settings = plain_errors(_mosbench.method_settings, method, None)
        self._set(settings)

    @classmethod
    def preset(cls, name: str, method: Optional[str] = None) -> "Config":
        """Returns the published settings of this name; `mosbench.presets()` lists them.

        They are for "hmm-mos" when no method is named; "best" is of "hmm-mos-plus". As a Config knows no data set,
        "best" has all defaults of that method, also its voxels of 0.2 m and range of 0.5 to 20 m, while
        `run(data, preset="best")` takes voxels and range of the data set's own preset. Those settings are
        `Config.preset("semantickitti", method="hmm-mos-plus")`, with the preset of your data set.
        """
        named = plain_errors(_mosbench.method_name, method, name)
        return cls._of(named, plain_errors(_mosbench.method_settings, named, name), name)

    @classmethod
    def load(cls, file: Union[str, os.PathLike[str]], method: str = "hmm-mos") -> "Config":
        """Returns the defaults with the settings of a JSON object over them, as `--set @FILE` does."""
        settings = plain_errors(_mosbench.method_settings, method, None)
        with open(file, "rb"):
            pass  # OSError where there is no such file; ValueError is for what is in it
        settings.load(os.fspath(file))
        _mosbench.check_settings(method, settings)
        return cls._of(method, settings)

    @classmethod
    def _of(cls, method: str, settings: _mosbench.Settings, preset: Optional[str] = None) -> "Config":
        config = cls.__new__(cls)
        config._method, config._settings, config._preset = method, settings, preset
        return config

    def replace(self, **settings: SettingValue) -> "Config":
        """Returns a copy with other values of some settings."""
        replaced = self._of(self._method, copy.copy(self._settings), self._preset)
        replaced._set(settings)
        return replaced

    def _set(self, settings: Mapping[str, SettingValue]) -> None:
        _set(self._settings, settings)
        _mosbench.check_settings(self._method, self._settings)

    @property
    def method(self) -> str:
        """Name of the method."""
        return self._method

    @property
    def preset_name(self) -> Optional[str]:
        """Name of the preset that it was made from, None for the method's defaults."""
        return self._preset

    def changed(self) -> dict[str, SettingValue]:
        """Returns the settings that differ from the method's defaults, which for "hmm-mos" are the paper's."""
        defaults = plain_errors(_mosbench.method_settings, self._method, None).to_dict()
        return {name: value for name, value in self.to_dict().items() if defaults.get(name) != value}

    def to_dict(self) -> dict[str, SettingValue]:
        """Returns every setting that has a value of its own, in the method's order."""
        return self._settings.to_dict()

    def describe(self) -> list[dict[str, Any]]:
        """Returns name, value, legal values and meaning of every setting."""
        return self._settings.describe()

    def __getitem__(self, name: str) -> SettingValue:
        return self.to_dict()[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.to_dict())

    def __len__(self) -> int:
        return len(self.to_dict())

    def __reduce__(self) -> tuple[Any, ...]:
        return _config_of, (self._method, self.to_dict(), self._preset)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Config):
            return NotImplemented
        return self._method == other._method and self.to_dict() == other.to_dict()

    def __repr__(self) -> str:
        values = ", ".join(f"{name}={value!r}" for name, value in self.to_dict().items())
        return f"Config({self._method!r}, {values})"


def _config_of(method: str, settings: dict[str, SettingValue], preset: Optional[str]) -> Config:
    config = Config(method, **settings)
    config._preset = preset
    return config


def refuse_no_settings(config: Any) -> None:
    """Raises TypeError, or for the name of a file or preset ValueError, for what holds no settings."""
    if isinstance(config, (str, os.PathLike)):
        raise ValueError("config: is a text, expected settings by name, Config.preset(...) or Config.load(...)")
    if config is not None and not isinstance(config, collections.abc.Mapping):
        raise TypeError(f"config: is {type(config).__name__}, expected a Config, or settings by name")


@dataclasses.dataclass(frozen=True)
class Labels:
    """The final labels of one scan."""

    index: int  #: which pushed scan, from 0
    labels: Array  #: uint32 (N,): 9 static, 251 moving
    scores: Optional[Array]  #: float32 (N,), larger is more likely to move; None unless asked for
    reasons: Optional[Array]
    """uint8 (N,), with scores of "hmm-mos-plus": why a point moves: 0 it does not, 1 arrived in free space,
    2 left free space behind, 3 connected with such, 4 feet of what moves, 5 where what moved before is
    expected. Else None."""
    objects: Optional[Array]
    """uint32 (N,): number of the moving object, from 1 and the same in all scans, 0 for none; None when
    the method finds no objects."""
    threshold: Optional[float]  #: that the method compared scores with
    judged: bool  #: False: too little past or future, all points are labelled static
    stages_ms: dict[str, float]  #: wall time of each stage

    @property
    def moving(self) -> Array:
        """bool (N,)."""
        moving: Array = self.labels == _mosbench.MOVING_LABEL
        return moving


class MOS:
    """Segments scans that are pushed in order. Labels are the same bits for any number of threads."""

    def __init__(
        self,
        config: Union[Config, Mapping[str, SettingValue], None] = None,
        method: Optional[str] = None,
        *,
        threads: int = 1,
        scan_count: Optional[int] = None,
        scores: bool = False,
    ):
        """Takes a config, or settings by name over the method's defaults ("hmm-mos" when none is named).

        `MOS()` is `MOS(Config())`, the defaults of "hmm-mos", and no preset: `run` without one takes that of
        the data set instead. Presets: `MOS(Config.preset(name))`. They judge points to 20 m; `repr` says preset, range and all settings
        that differ from the method's defaults.
        A config is of one method: `Config.preset(name, method=...)` and `Config(method, ...)` make one.
        `scan_count` is the length of the sequence where it is known: the end of a delayed run may be
        labelled in another way.
        """
        if not isinstance(config, Config):
            refuse_no_settings(config)
            config = Config(method or "hmm-mos", **dict(config or {}))
        elif method not in (None, config.method):
            raise ValueError(f"method: is {method}, expected {config.method} as config has it")
        self._config = config
        threads = whole_number(threads, "threads", 1, MOST_THREADS)
        scan_count = None if scan_count is None else whole_number(scan_count, "scan_count", 0)
        self._method = _mosbench.Method(config.method, config._settings, threads, scan_count, bool(scores))

    @property
    def config(self) -> Config:
        """The settings that it runs with."""
        return self._config

    @property
    def range_m(self) -> Optional[tuple[float, float]]:
        """From and to which range points are judged; what lies outside is static. None for methods without range."""
        settings = self._config.to_dict()
        low, high = settings.get("min_range_m"), settings.get("max_range_m")
        return None if low is None or high is None else (float(low), float(high))

    def __repr__(self) -> str:
        preset = self._config.preset_name
        parts = [repr(self._config.method), f"preset {preset!r}" if preset else "no preset: the method's defaults"]
        if self.range_m is not None:
            parts.append("judges {:g} to {:g} m".format(*self.range_m))
        parts += [f"{name}={value!r}" for name, value in self._config.changed().items()]
        return f"MOS({', '.join(parts)})"

    def push(self, points: Any, pose: Any, origins: Any = None) -> list[Labels]:
        """Takes a scan in and returns the scans whose labels became final.

        points: (N, 3) or (N, 4), sensor frame, metres; float32 (N, 4) in C order is not copied.
        pose: (4, 4), map_from_sensor.
        origins: (N, 3), where the ray of each point starts, of several sensors; None: at the sensor.
        """
        cloud = as_array(points, "points"), as_array(pose, "pose")
        return [Labels(**scan) for scan in self._method.push(*cloud, *_places(origins))]

    def finish(self) -> list[Labels]:
        """Returns what a delay still holds back. Nothing can be pushed after it."""
        return [Labels(**scan) for scan in self._method.finish()]

    @property
    def remarks(self) -> list[str]:
        """What a reader of the labels should know about them."""
        return self._method.remarks()

    @property
    def memory_bytes(self) -> Optional[int]:
        """Of the method's containers; None when it does not measure them."""
        return self._method.memory_bytes()


def _places(origins: Any) -> tuple[Array, Array]:
    """Returns the different rows of origins, and which of them is each point's."""
    if origins is None:
        return np.empty((0, 3)), np.empty(0, np.uint8)
    origins = as_array(origins, "origins")
    if origins.ndim != 2 or origins.shape[1] != 3:
        raise ValueError(f"origins: has shape {origins.shape}, expected (N, 3)")
    places, place_of_point = np.unique(origins.astype(np.float64), axis=0, return_inverse=True)
    if len(places) > 256:
        raise ValueError(f"origins: are {len(places)} places, expected at most 256")
    return places, place_of_point.reshape(-1).astype(np.uint8)


@dataclasses.dataclass(frozen=True)
class OdometryPose:
    """The pose of one scan."""

    pose: Array  #: (4, 4), map_from_sensor; the map's frame is that of the first scan
    covariance: Array  #: (6, 6), rotation (rad), then translation (m), in the map's frame
    geometry: float  #: how much the surfaces constrain the least constrained motion, 0 to 1/3
    condition: float  #: of the covariance's inverse
    overlap: float  #: share of the points that lie where the map has points
    doubt: str  #: why the pose is not to be trusted; empty when it is


class Odometry:
    """Finds the pose of each scan from the scans alone, in order."""

    def __init__(
        self,
        kind: str = "simple",
        preset: Optional[str] = None,
        *,
        threads: int = 1,
        **settings: SettingValue,
    ):
        """kind: "simple" (SiMpLE) or "kiss" (KISS-ICP)."""
        values = plain_errors(_mosbench.odometry_settings, kind, preset)
        _set(values, settings)
        self._odometry = _mosbench.Odometry(kind, values, whole_number(threads, "threads", 1, MOST_THREADS))

    def push(
        self, points: Any, stamp_ns: Optional[int] = None, point_times_ns: Any = None
    ) -> OdometryPose:
        """points: as MOS.push; point_times_ns: (N,) after the stamp, for moving the points by them."""
        stamp_ns = None if stamp_ns is None else whole_number(stamp_ns, "stamp_ns")
        times_ns = [] if point_times_ns is None else _times_ns(point_times_ns)
        return OdometryPose(**self._odometry.push(as_array(points, "points"), stamp_ns, times_ns))


def _times_ns(times: Any) -> list[int]:
    times = as_array(times, "point_times_ns")
    if times.ndim != 1 or times.dtype.kind not in "fiu" or not np.isfinite(times).all():
        raise ValueError(f"point_times_ns: has shape {times.shape}, type {times.dtype}, expected (N,) finite numbers")
    whole: list[int] = times.astype(np.int64).tolist()
    return whole


def odometry(scans: Iterable[Any], kind: str = "simple", **options: Any) -> Array:
    """Returns the poses (K, 4, 4) of scans in order.

    scans: arrays of points, a sequence of `mosbench.open`, the folder of one, or an object with
    `len` and `[i] -> (points (N, 3), times)` as KISS-ICP takes data sets; times of points are used
    unless deskew="none" is among the options.
    """
    if isinstance(scans, (str, os.PathLike)):
        scans = open_data(scans, poses=False)
    if len(sequences := getattr(scans, "sequences", ())) > 1:
        names = ", ".join(sequence.name for sequence in sequences)
        raise ValueError(f"scans: are {len(sequences)} sequences, expected one, as data[name]: {names}")
    scans = sequences[0] if sequences else scans
    engine = Odometry(kind, **options)
    poses = []
    for index, scan in enumerate(scans):
        if isinstance(scan, Scan):
            found = engine.push(scan.points, scan.stamp_ns, scan.point_times_ns)
        elif isinstance(scan, tuple):
            times_s = seconds_after_stamp(scan[1], len(scan[0]), index)
            found = engine.push(scan[0], None, None if times_s is None else np.rint(1e9 * times_s))
        else:
            found = engine.push(scan)
        poses.append(found.pose)
    return np.stack(poses) if poses else np.empty((0, 4, 4))
