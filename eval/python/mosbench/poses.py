"""Poses in arrays, and files of them."""

from __future__ import annotations

import contextlib
import os
import pathlib
import tempfile
from typing import Any, Iterator, Optional, Sequence, Union

import numpy as np

from mosbench import _mosbench
from mosbench.arrays import Array, as_array
from mosbench.flags import whole_number

ROTATION_TOLERANCE = 1e-3  #: of R^T R, as readers of files have it


def is_path(poses: Any) -> bool:
    """Whether poses are given as a file or folder, and not as matrices."""
    return isinstance(poses, (str, os.PathLike))


def checked_poses(poses: Any, name: str) -> Array:
    """Returns poses as float64 (K, 4, 4). Raises ValueError naming the first that is no rigid motion."""
    if isinstance(poses, (list, tuple)):
        poses = [as_array(pose, name) for pose in poses]
    given = as_array(poses, name)
    try:
        matrices = given.astype(np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"{name}: are no numbers, expected (K, 4, 4)") from None
    if matrices.ndim != 3 or matrices.shape[1:] != (4, 4):
        raise ValueError(f"{name}: has shape {matrices.shape}, expected (K, 4, 4)")
    for k, matrix in enumerate(matrices):
        if not np.isfinite(matrix).all():
            raise ValueError(f"{name}[{k}]: is not finite, expected finite numbers")
        if (matrix[3] != (0, 0, 0, 1)).any():
            raise ValueError(f"{name}[{k}]: has another last row, expected 0 0 0 1")
        rotation = matrix[:3, :3]
        if not (np.abs(rotation.T @ rotation - np.eye(3)) <= ROTATION_TOLERANCE).all():
            raise ValueError(f"{name}[{k}]: is not rigid, expected a rotation and a translation")
    return matrices


def write_poses(
    path: Union[str, os.PathLike[str]], poses: Any, format: str = "kitti", stamps: Optional[Sequence[int]] = None
) -> None:
    """Writes a file for `poses=` and `--poses`, of poses map_from_sensor in the LiDAR's frame.

    poses: (K, 4, 4), or a list of (4, 4), metres.
    format: "kitti" writes rows of 12 numbers, and beside them `<path>.frame`, which says that they are the
    LiDAR's: without it they are taken for the camera's where calib.txt holds a Tr. "tum" writes
    stamp x y z qx qy qz qw, with a name in .tum.
    stamps: (K,) whole nanoseconds, rising; for "tum" alone.
    Raises ValueError for what is no rigid motion, and for stamps that do not fit; OSError.
    """
    matrices = checked_poses(poses, "poses")
    if format not in ("kitti", "tum"):
        raise ValueError(f"format: is {format!r}, expected 'kitti' or 'tum'")
    if (stamps is None) == (format == "tum"):
        raise ValueError(f"stamps: are {'not ' if stamps is None else ''}given, expected them with format='tum' alone")
    _mosbench.write_poses(os.fspath(path), list(matrices), None if stamps is None else _stamps(stamps, len(matrices)))


def _stamps(stamps: Sequence[int], count: int) -> list[int]:
    stamps_ns = [whole_number(stamp, f"stamps[{k}]") for k, stamp in enumerate(stamps)]
    if len(stamps_ns) != count:
        raise ValueError(f"stamps: are {len(stamps_ns)}, expected {count} as there are poses")
    for k in range(1, count):
        if stamps_ns[k] <= stamps_ns[k - 1]:
            raise ValueError(f"stamps[{k}]: is {stamps_ns[k]}, expected a later one than {stamps_ns[k - 1]} before")
    return stamps_ns


def write_changed(file: pathlib.Path, content: bytes) -> None:
    """Leaves a file alone that has the content already, so that finished runs over it stay finished."""
    if not file.exists() or file.read_bytes() != content:
        file.write_bytes(content)


def keep_poses(file: pathlib.Path, poses: Any, name: str) -> None:
    """Writes KITTI's rows and their mark, unless the file has them already."""
    with tempfile.TemporaryDirectory() as folder:
        made = pathlib.Path(folder, "poses.txt")
        write_poses(made, checked_poses(poses, name))
        for suffix in ("", ".frame"):
            write_changed(pathlib.Path(f"{file}{suffix}"), pathlib.Path(f"{made}{suffix}").read_bytes())


class PoseFiles:
    """Files of poses by name; those of arrays are temporary."""

    def __init__(self, folder: str):
        self._folder = folder
        self._names: dict[str, str] = {}

    def path(self, poses: Any, name: str) -> str:
        """Returns the file, or that to which it wrote the array."""
        if is_path(poses):
            named: str = os.fspath(poses)
            return named
        file = os.path.join(self._folder, f"{name}.txt")
        write_poses(file, checked_poses(poses, name))
        self._names[file] = name
        return file

    def reading(self, reading: dict[str, Any]) -> dict[str, Any]:
        """Returns how to read data with a file where poses are an array."""
        poses = reading.get("poses")
        return reading if poses is None else {**reading, "poses": self.path(poses, "poses")}

    def named(self, text: str) -> str:
        """Returns a text with names instead of temporary files."""
        for file, name in self._names.items():
            text = text.replace(file, name)
        return text


@contextlib.contextmanager
def pose_files() -> Iterator[PoseFiles]:
    """Gives files to poses while they are read; errors about an array name it and are ValueErrors."""
    with tempfile.TemporaryDirectory() as folder:
        files = PoseFiles(folder)
        try:
            yield files
        except (OSError, ValueError) as error:
            if (text := files.named(str(error))) == str(error):
                raise
            raise ValueError(text) from None
