"""Readers of data sets."""

from __future__ import annotations

import dataclasses
import os
import pathlib
from typing import Any, Iterator, Optional, Sequence as List, Union, overload

import numpy as np

from mosbench import _mosbench
from mosbench.arrays import Array
from mosbench.flags import plain_errors, reading_flags
from mosbench.poses import pose_files

PathLike = Union[str, os.PathLike[str]]
SCAN_S = 0.1  #: how long a scan is taken to last where nothing says it


@dataclasses.dataclass(frozen=True)
class Opened:
    """How a data set was opened, for commands to open it again."""

    path: str
    dataset: str
    sequences: tuple[str, ...]  #: all when empty
    reading: dict[str, Any]


@dataclasses.dataclass(frozen=True)
class Scan:
    """One scan as its data set gives it."""

    index: int  #: in the sequence, from 0
    stem: str  #: file name without extension
    points: Array  #: float32 (N, 4): x, y, z in metres in the sensor frame, intensity
    pose: Array  #: float64 (4, 4), map_from_sensor
    stamp_ns: Optional[int]  #: when it was measured; None when the data set has no stamps
    point_times_ns: Optional[Array]  #: int64 (N,), when each point was measured after the stamp
    #: float32 (N,), of the surface relative to the sensor, positive away from it; of an Aeva, else None
    radial_velocity_m_s: Optional[Array]
    truth: Optional[Array]  #: uint32 (N,), raw labels: id, and in the upper 16 bits instance; None without
    origins: Optional[Array] = None  #: float64 (N, 3), where rays start, of several LiDARs; else None

    @property
    def truth_ids(self) -> Optional[Array]:
        """uint32 (N,), the ids of truth alone: of SemanticKITTI, 251 to 259 move."""
        return None if self.truth is None else self.truth & 0xFFFF

    @property
    def stamp(self) -> Optional[float]:
        """stamp_ns in seconds; a float64 holds today's date to a quarter of a microsecond."""
        return None if self.stamp_ns is None else self.stamp_ns * 1e-9


class Sequence:
    """Scans of one sensor in order; reads each when it is asked for.

    Iterating gives a `Scan` each, `scan(i)` one of them. Also a data set as KISS-ICP takes them, and so
    `sequence[i]` is no Scan but (points (N, 3) float64, times (N,) 0 to 1); `gt_poses` is (K, 4, 4).
    """

    def __init__(self, opened: _mosbench.Sequence, opened_by: Opened):
        self._opened = opened
        self.opened_by = dataclasses.replace(opened_by, sequences=(self.name,))

    @property
    def name(self) -> str:
        """Folder of its results; unique in its data set."""
        return self._opened.name

    @property
    def remarks(self) -> list[str]:
        """What was assumed."""
        return self._opened.remarks

    @property
    def warnings(self) -> list[str]:
        """What makes numbers of it doubtful, as far as no scan has to be read."""
        return self._opened.warnings

    @property
    def simulated(self) -> bool:
        """Whether it was simulated, or made of a sequence that was."""
        return self._opened.simulated

    @property
    def gt_poses(self) -> Array:
        """float64 (K, 4, 4), map_from_sensor."""
        return self._opened.poses

    def scan(self, index: int) -> Scan:
        """Reads a scan; negative indices count from the end."""
        count = len(self)
        if not -count <= index < count:
            raise IndexError(f"{self.name}: has {count} scans, not one at {index}")
        return Scan(**self._opened.read(index % count))

    def __len__(self) -> int:
        return len(self._opened)

    def __iter__(self) -> Iterator[Scan]:
        return (self.scan(index) for index in range(len(self)))

    def __getitem__(self, index: int) -> tuple[Array, Array]:
        """Points and times as KISS-ICP takes them."""
        scan = self.scan(index)
        times = np.zeros(0)
        if scan.point_times_ns is not None:
            last_ns = max(int(scan.point_times_ns.max(initial=0)), 1)
            times = scan.point_times_ns / last_ns
        return scan.points[:, :3].astype(np.float64), times

    def __repr__(self) -> str:
        simulated = ", simulated" if self.simulated else ""
        return f"<mosbench.Sequence {self.name}: {len(self)} scans{simulated}>"


class Dataset:
    """The sequences of a data set, by name or number: `len`, `data[i]`, `data["08"]` and iteration are of them."""

    def __init__(self, opened: _mosbench.Dataset, opened_by: Opened):
        self._opened = opened
        self.opened_by = dataclasses.replace(opened_by, dataset=opened.kind)
        self.sequences: list[Sequence] = [Sequence(one, self.opened_by) for one in opened.sequences()]

    @property
    def kind(self) -> str:
        """Layout: "semantickitti", "doals", ..."""
        return self._opened.kind

    @property
    def root(self) -> pathlib.Path:
        """Folder of the data set."""
        return pathlib.Path(self._opened.root)

    @property
    def remarks(self) -> list[str]:
        """What was assumed about the whole data set."""
        return self._opened.remarks

    def __getitem__(self, name: Union[str, int]) -> Sequence:
        if isinstance(name, (int, np.integer)):
            return self.sequences[name]
        for sequence in self.sequences:
            if sequence.name == name:
                return sequence
        known = ", ".join(sequence.name for sequence in self.sequences)
        raise KeyError(f"{self.root} has no sequence {name}, expected one of {known}")

    def __len__(self) -> int:
        return len(self.sequences)

    def __iter__(self) -> Iterator[Sequence]:
        return iter(self.sequences)

    def __repr__(self) -> str:
        return f"<mosbench.Dataset {self.kind} at {self.root}: {len(self)} sequences>"


def seconds_after_stamp(times: Any, count: int, index: int) -> Optional[Array]:
    """The times that KISS-ICP's data sets give beside points, 0 to 1 over a scan or in any unit, as (N,) seconds.

    A scan is taken to begin at its stamp and to last 0.1 s. None where there are no times.
    Raises ValueError for another count and for times that are not finite.
    """
    given: Array = np.asarray(times, dtype=np.float64).ravel()
    if given.size == 0:
        return None
    if given.size != count or not np.isfinite(given).all():
        raise ValueError(f"scan {index}: has {given.size} times for {count} points, expected a finite one for each")
    low, high = given.min(), given.max()
    if low < 0 or high > 1:
        given = (given - low) / (high - low or 1.0)
    return SCAN_S * given


@overload
def open(path: PathLike, sequence: str, *, dataset: str = "auto", poses: Any = None, **reading: Any) -> Sequence: ...


@overload
def open(
    path: PathLike,
    sequence: None = None,
    *,
    dataset: str = "auto",
    sequences: List[str] = (),
    poses: Any = None,
    **reading: Any,
) -> Union[Dataset, Sequence]: ...


def open(
    path: PathLike,
    sequence: Optional[str] = None,
    *,
    dataset: str = "auto",
    sequences: List[str] = (),
    poses: Any = None,
    **reading: Any,
) -> Union[Dataset, Sequence]:
    """Opens a data set, or with `sequence`, or of a folder with a single one, that sequence.

    poses: a file to take instead of the sequence's own, or (K, 4, 4), or a list of (4, 4), map_from_sensor
    of the LiDAR; False: read none, every pose is the identity.
    reading: as READING lists them.
    Raises OSError for what cannot be read, ValueError for a sequence that is not there.
    """
    several = [sequences] if isinstance(sequences, str) else [str(name) for name in sequences]
    names = several if sequence is None else [sequence]
    if poses is True:
        raise ValueError("poses: is True, expected a file, (K, 4, 4), False, or None for the sequence's own")
    given = {"poses": poses, **reading}
    with_poses = poses is not False
    with pose_files() as files:
        read = reading_flags(files.reading({**given, "poses": poses if with_poses else None}))
        found = plain_errors(_mosbench.open, os.fspath(path), dataset, names, read, with_poses)
    opened = Dataset(found, Opened(os.path.abspath(path), dataset, tuple(names), given))
    return opened.sequences[0] if len(opened) == 1 and not several else opened
