#!/usr/bin/env python3
"""Checks that each room includes only the rooms below it, and that core neither reads nor prints."""

import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Words and numbers, files on disk, and one parser per format.
FILES = {"datasets/text", "datasets/disk", "datasets/formats"}
DATASETS = FILES | {"datasets/sequence", "datasets/perturb", "datasets/layouts"}
# What eval uses of core apart from the public face: threads and clocks.
THREADS = {"core/include", "core/base"}
NUMBERS = {
    "eval/answer", "eval/engine", "eval/job", "eval/protocols", "eval/predictions", "eval/result", "eval/statistics", "eval/store",
}
# Rooms that the files of a room may include in addition to their own. A name with a slash at the end means
# all rooms below it.
MAY_INCLUDE = {
    "core/include": set(),
    "core/base": {"core/include"},
    "core/voxel": {"core/include", "core/base"},
    # Signed distances around the sensor, for the methods that judge by them.
    "core/tsdf": {"core/include", "core/base", "core/voxel"},
    # Whole object tracks, for the methods that offer a delay of all scans.
    "core/tracks": {"core/include", "core/base"},
    "core/methods/hmm_mos": {"core/include", "core/base", "core/voxel", "core/tracks"},
    "core/methods/dynablox": {"core/include", "core/base", "core/voxel", "core/tsdf"},
    "core/methods/lc_free_space": {"core/include", "core/base", "core/voxel", "core/tsdf"},
    # Stands on the map of the paper's method.
    "core/methods/hmm_mos_plus": {"core/include", "core/base", "core/voxel", "core/tracks", "core/methods/hmm_mos"},
    # The table of all methods.
    "core/methods": {"core/"},
    "datasets/text": {"core/include"},
    "datasets/disk": {"core/include", "datasets/text"},
    "datasets/formats": {"core/include", "datasets/text", "datasets/disk"},
    "datasets/sequence": THREADS | FILES,
    "datasets/perturb": {"core/include", "datasets/sequence"} | FILES,
    "datasets/rosbag": {"core/include", "datasets/sequence"} | FILES,
    "datasets/hdf5": {"core/include", "datasets/sequence"} | FILES,
    "datasets/layouts": {"core/include", "datasets/rosbag", "datasets/hdf5"} | DATASETS,
    "datasets/simulator": THREADS | DATASETS,
    "datasets/doctor": {"core/include"} | DATASETS,
    "eval/answer": {"datasets/text"},
    "eval/protocols": {"core/include", "datasets/"},
    "eval/predictions": {"core/include", "datasets/", "eval/protocols"},
    "eval/result": {"core/include", "datasets/", "eval/answer", "eval/protocols", "eval/predictions"},
    # A method that is a process of the user: it needs no data set, only how errors and files are written.
    "eval/exec": {"core/include"} | FILES,
    # What is asked, parsed once.
    "eval/job": {"core/include", "datasets/", "eval/exec", "eval/protocols", "eval/predictions", "eval/result"},
    # Where results lie; it knows nothing of methods.
    "eval/store": {"core/include", "datasets/", "eval/answer", "eval/protocols", "eval/result"},
    "eval/engine": THREADS | {"datasets/", "eval/answer", "eval/exec", "eval/job", "eval/protocols", "eval/predictions", "eval/result", "eval/store"},
    "eval/statistics": {"core/include", "datasets/", "eval/answer", "eval/protocols", "eval/result"},
    "eval/trajectory": {"core/include", "datasets/", "eval/answer", "eval/result", "eval/statistics"},
    "eval/static_map": {"core/include", "datasets/", "eval/answer", "eval/result"},
    # Tracks that a person decides on: it reads what runs wrote, and writes labels.
    "eval/truth": {"core/include", "datasets/", "eval/answer", "eval/protocols", "eval/predictions", "eval/result"},
    "eval/breakdown": THREADS | {"datasets/"} | NUMBERS,
    "eval/tables": {"core/include", "datasets/"} | NUMBERS,
    "eval/report": THREADS | {"datasets/", "eval/breakdown", "eval/static_map", "eval/tables", "eval/trajectory"} | NUMBERS,
    "eval/study": {"core/include", "datasets/", "eval/report"} | NUMBERS,
    "eval/cli": THREADS | {"datasets/", "eval/"},
    "eval/python": THREADS | {"datasets/", "eval/"},
    "bench": {"core/", "datasets/", "eval/"},
    "tests/examples": {"core/include", "core/base", "tests/examples"},
    "tests": {"core/", "datasets/", "eval/", "bench", "tests/"},
}
# Any other folder of core/methods is a method, as is odometry. None includes another.
METHOD = {"core/include", "core/base", "core/voxel"}
ABOVE_CORE = {"datasets", "eval", "bench", "tests"}
TOP = ABOVE_CORE | {"core"}
CPP = ("hpp", "cpp", "h", "hh", "hxx", "ipp", "inl", "cc", "cxx", "c")
# <header> or <folder/...> that only some top folders, or single files, may use.
EXTERNAL = {
    "CLI": {"eval", "tests"},
    "pybind11": {"eval"},
    "pcl": {"core/include/mosbench/pcl.hpp", "tests"},
    "octomap": {"core/methods/octomap/log_odds_map.cpp", "bench/octomap.cpp", "tests"},
    "hdf5.h": {"datasets/hdf5/hdf5_module.cpp"},
    "fmt": ABOVE_CORE,
    "nlohmann": ABOVE_CORE,
    "xxhash.h": {"datasets", "eval", "tests"},
    "utf8.h": {"datasets"},
    "nanoflann.hpp": {"eval"},
    "yaml-cpp": {"eval"},
}
# In these rooms only the files that print may use JSON: what computes takes and gives types.
COMPUTE = {"eval/statistics", "eval/tables"}
PRINTS = re.compile(r"\w+_(report|print)\.[ch]pp|side_by_side\.[ch]pp")
# All that core may take from outside, apart from the above: it computes, and neither reads nor prints.
FOR_CORE = set(
    "Eigen algorithm array atomic bit cassert cfloat chrono cmath condition_variable cstddef cstdint"
    " cstdlib cstring deque emmintrin.h exception functional iomanip limits memory mutex new numbers"
    " numeric optional set map span sstream stdexcept string string_view thread time.h tuple type_traits"
    " unordered_map unordered_set utility variant vector".split()
)
INCLUDE = re.compile(r'\s*#\s*include\s*([<"])([^>"]+)[>"]')
# Other spellings of the same, which would pass unseen.
ODD_INCLUDE = re.compile(r"\s*(#|%:|\?\?=|/\*.*\*/).*\b(include|import|embed)\b")


def room_of(name):
    """The row of MAY_INCLUDE that a file belongs to; its folder when there is none."""
    folders = name.split("/")[:-1]
    if folders[:2] == ["core", "methods"]:
        return "/".join(folders[:3])
    for depth in (2, 1):
        room = "/".join(folders[:depth])
        if room in MAY_INCLUDE:
            return room
    return "/".join(folders[:2])


def allows(room, other):
    if other == room:
        return True
    return any(
        other == allowed or (allowed.endswith("/") and (other + "/").startswith(allowed))
        for allowed in MAY_INCLUDE.get(room, METHOD)
    )


def complaint(name, quote, header):
    """What is wrong with this include in this file; None when nothing is."""
    room = room_of(name)
    top, first = room.split("/")[0], header.split("/")[0]
    if ".." in header.split("/") or (quote == "<" and first in TOP):
        return f"{header} is not written as a path from the top folder in quotes"
    if quote == "<" and first == "mosbench":
        path = "core/include/" + header
    elif quote == "<":
        if first == "nlohmann" and room in COMPUTE and not PRINTS.fullmatch(name.split("/")[-1]):
            return f"{name.split('/')[-1]} computes, and must not use JSON"
        allowed = EXTERNAL.get(first, TOP if first in FOR_CORE else ABOVE_CORE)
        return None if {top, name} & allowed else f"{top} must not use <{header}>"
    else:
        path = header
    if not (ROOT / path).is_file() or (quote == '"' and path.startswith("core/include/")):
        return f'{header} is neither a path from the top folder nor <mosbench/...>'
    other = room_of(path)
    return None if allows(room, other) else f"{room} must not include {other}"


def main():
    patterns = [f"{top}/*.{ending}" for top in sorted(TOP) for ending in CPP]
    listed = subprocess.run(
        ["git", "-C", ROOT, "ls-files", "--cached", "--others", "--exclude-standard", *patterns], check=True, capture_output=True, text=True
    ).stdout.split()
    # The consumer of the installed library is a project of its own.
    files = [name for name in listed if not name.startswith("tests/install/")]
    wrong = 0
    for name in files:
        room = room_of(name)
        if room not in MAY_INCLUDE and not room.startswith("core/"):
            print(f"{name}: {room} is no row of MAY_INCLUDE")
            wrong += 1
        if not name.endswith((".hpp", ".cpp")):
            print(f"{name}: has another ending than .hpp and .cpp")
            wrong += 1
        for number, line in enumerate((ROOT / name).read_text().splitlines(), start=1):
            match = INCLUDE.match(line)
            odd = "is no plain #include" if not match and ODD_INCLUDE.match(line) else None
            if text := complaint(name, *match.groups()) if match else odd:
                print(f"{name}:{number}: {text}")
                wrong += 1
    print(f"includes of {len(files)} files checked, {wrong} wrong")
    return 1 if wrong or not files else 0


if __name__ == "__main__":
    sys.exit(main())
