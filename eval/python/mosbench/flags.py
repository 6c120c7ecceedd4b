"""Flags of the program out of arguments of Python."""

from __future__ import annotations

import operator
import os
import re
from typing import Any, Callable, Mapping, TypeVar

from mosbench import _mosbench

#: How data are read; `mosbench run --help` says what each means. `poses` may also be an array (K, 4, 4) of
#: map_from_sensor of the LiDAR, `scans` a slice; what is a switch there is True here.
READING = tuple(_mosbench.reading_names())


#: Those that have a flag of their own; the others are keys of --read.
FLAGS = ("scans", "poses", "refine_poses", "topic", "point_times", "deskew", "perturb")


def flags(**values: Any) -> list[str]:
    """Returns --name=value of those that are given; true alone gives --name."""
    arguments = []
    for name, value in values.items():
        flag = "--" + name.replace("_", "-")
        if value is None or value is False:
            continue
        if value is True:
            arguments.append(flag)
        elif isinstance(value, (list, tuple)):
            arguments.append(f"{flag}={','.join(map(str, value))}")
        else:
            arguments.append(f"{flag}={os.fspath(value) if isinstance(value, os.PathLike) else value}")
    return arguments


def reading_flags(reading: Mapping[str, Any]) -> list[str]:
    """Returns the flags of READING. Raises TypeError for another name, as Python does."""
    for name in reading:
        if name not in READING:
            raise TypeError(f"got an unexpected keyword argument {name!r}, expected one of {', '.join(READING)}")
    if reading.get("raw_scans"):
        reading = {"deskew": "none", **{name: value for name, value in reading.items() if name != "raw_scans"}}
    if isinstance(part := reading.get("scans"), (slice, range)):
        words = ("" if number is None else str(number) for number in (part.start, part.stop, part.step))
        reading = {**reading, "scans": ":".join(words)}
    said = {name: value for name, value in reading.items() if name in FLAGS}
    rare = [f"{name}={'on' if value is True else value}" for name, value in reading.items()
            if name not in FLAGS and value is not None and value is not False]  # fmt: skip
    return [*flags(**said), *flags(read=rare or None)]


def _in_python(message: str) -> str:
    """Returns a message of the program with arguments where it names flags."""
    message = re.sub(r"mosbench run .* --odometry (\w+)", r"run(odometry='\1')", message)
    message = message.replace("--read ", "")
    message = re.sub(r"; see mosbench [\w ]*--help", "", message)
    return re.sub(r"(?<![\w-])--([a-z][a-z0-9-]*)", lambda match: match[1].replace("-", "_"), message)


Answer = TypeVar("Answer")


def plain_errors(call: Callable[..., Answer], *arguments: Any) -> Answer:
    """Calls; ValueError and OSError come in the words of Python."""
    try:
        return call(*arguments)
    except (ValueError, OSError) as error:
        raise type(error)(_in_python(str(error))) from None


INT64 = 2**63


def whole_number(value: Any, name: str, least: int = -INT64, most: int = INT64 - 1) -> int:
    """Returns an int. Raises TypeError for what is no whole number, ValueError for one out of range."""
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name}: is {value!r}, expected a whole number") from None
    if not least <= number <= most:
        legal = f"{least} or more" if number < least and most == INT64 - 1 else f"{least} to {most}"
        raise ValueError(f"{name}: is {number}, expected {legal}")
    return number
