#!/usr/bin/env python3
"""Checks that each room includes only the rooms below it, and that core neither reads nor prints."""

import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
DATASETS = {"datasets/files", "datasets/sequence", "datasets/layouts"}
# What eval uses of core apart from the public face: threads and clocks.
THREADS = {"core/include", "core/base"}
NUMBERS = {"eval/protocols", "eval/predictions", "eval/results", "eval/runs", "eval/statistics"}
# Rooms that the files of a room may include in addition to their own. A name with a slash at the end means
# all rooms below it.
MAY_INCLUDE = {
    "core/include": set(),
    "core/base": {"core/include"},
    "core/voxel": {"core/include", "core/base"},
    "core/hmm_mos": {"core/include", "core/base", "core/voxel"},
    "core/odometry": {"core/include", "core/base", "core/voxel"},
    "core": {"core/include", "core/base", "core/hmm_mos"},
    "datasets/files": {"core/include"},
    "datasets/sequence": {"core/include", "datasets/files"},
    "datasets/rosbag": {"core/include", "datasets/files", "datasets/sequence"},
    "datasets/layouts": {"core/include", "datasets/files", "datasets/sequence", "datasets/rosbag"},
    "datasets/simulator": THREADS | DATASETS,
    "datasets/doctor": {"core/include"} | DATASETS,
    "eval/protocols": {"core/include", "datasets/"},
    "eval/predictions": {"core/include", "datasets/", "eval/protocols"},
    "eval/results": {"core/include", "datasets/", "eval/protocols"},
    "eval/runs": THREADS | {"datasets/", "eval/protocols", "eval/predictions", "eval/results"},
    "eval/statistics": {"core/include", "datasets/", "eval/protocols", "eval/results"},
    "eval/trajectory": {"core/include", "datasets/", "eval/results"},
    "eval/breakdown": THREADS | {"datasets/"} | NUMBERS,
    "eval/tables": {"core/include", "datasets/"} | NUMBERS,
    "eval/report": THREADS | {"datasets/", "eval/breakdown", "eval/tables"} | NUMBERS,
    "eval/cli": THREADS | {"datasets/", "eval/"},
    "bench": {"core/", "datasets/", "eval/"},
    "tests/examples": {"core/include"},
    "tests": {"core/", "datasets/", "eval/", "bench", "tests/"},
}
ABOVE_CORE = {"datasets", "eval", "bench", "tests"}
# <header> or <folder/...> that only some top folders, or single files, may use.
EXTERNAL = {
    "CLI": {"eval", "tests"},
    "pcl": {"core/include/mosbench/pcl.hpp", "datasets", "tests"},
    "fmt": ABOVE_CORE,
    "nlohmann": ABOVE_CORE,
    "xxhash.h": {"datasets", "eval", "tests"},
    **{
        header: ABOVE_CORE
        for header in ("cstdio", "filesystem", "fstream", "iostream", "print", "stdio.h", "syncstream")
    },
}
GENERATED = {"mosbench_version.hpp": {"eval", "tests"}}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def room_of(name):
    """The row of MAY_INCLUDE that a file belongs to; its folder when there is none."""
    folders = name.split("/")[:-1]
    for depth in (2, 1):
        if "/".join(folders[:depth]) in MAY_INCLUDE and (depth == 1 or len(folders) >= 2):
            return "/".join(folders[:depth])
    return "/".join(folders)


def allows(room, other):
    if other == room:
        return True
    return any(
        other == allowed or (allowed.endswith("/") and (other + "/").startswith(allowed))
        for allowed in MAY_INCLUDE.get(room, ())
    )


def complaint(name, quote, header):
    """What is wrong with this include in this file; None when nothing is."""
    room = room_of(name)
    top = room.split("/")[0]
    if quote == "<" and header.startswith("mosbench/"):
        path = "core/include/" + header
    elif quote == "<":
        first = header.split("/")[0]
        if not {top, name} & EXTERNAL.get(first, {top}):
            return f"{top} must not use <{header}>"
        return None
    elif header in GENERATED:
        return None if top in GENERATED[header] else f'{top} must not use "{header}"'
    else:
        path = header
    if not (ROOT / path).is_file() or (quote == '"' and path.startswith("core/include/")):
        return f'{header} is neither a path from the top folder nor <mosbench/...>'
    other = room_of(path)
    return None if allows(room, other) else f"{room} must not include {other}"


def main():
    patterns = [f"{top}/*.{ending}" for top in ("core", "datasets", "eval", "bench", "tests") for ending in ("hpp", "cpp")]
    listed = subprocess.run(
        ["git", "-C", ROOT, "ls-files", *patterns], check=True, capture_output=True, text=True
    ).stdout.split()
    # The consumer of the installed library is a project of its own.
    files = [name for name in listed if not name.startswith("tests/install/")]
    wrong = 0
    for name in files:
        room = room_of(name)
        if room not in MAY_INCLUDE:
            print(f"{name}: {room} is no row of MAY_INCLUDE")
            wrong += 1
        for number, line in enumerate((ROOT / name).read_text().splitlines(), start=1):
            if (match := INCLUDE.match(line)) and (text := complaint(name, *match.groups())):
                print(f"{name}:{number}: {text}")
                wrong += 1
    print(f"includes of {len(files)} files checked, {wrong} wrong")
    return 1 if wrong or not files else 0


if __name__ == "__main__":
    sys.exit(main())
