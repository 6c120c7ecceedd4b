#!/usr/bin/env python3
"""Compiles the program from nothing and prints the CPU seconds that each room takes.

ccache is left out, so that the compiler itself is measured. Files are compiled one after the
other: where two share a core, each takes up to half as many CPU seconds more."""

import argparse
import collections
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
LOG = "MOSBENCH_COMPILE_LOG"
EXAMPLES = """examples:
  scripts/bench/compile_time.py
  scripts/bench/compile_time.py --most 300                # exit code 1 above 300 CPU seconds
  scripts/bench/compile_time.py -DMOSBENCH_WITH_PCL=ON"""


def launch(command):
    """Runs one compiler call, as CMake's launcher, and notes its CPU seconds and object file."""
    process = subprocess.Popen(command)
    _, status, usage = os.wait4(process.pid, 0)
    target = command[command.index("-o") + 1] if "-o" in command else "linking"
    with open(os.environ[LOG], "a") as log:
        log.write(f"{usage.ru_utime + usage.ru_stime:.2f} {target}\n")
    return os.waitstatus_to_exitcode(status)


def room_of(target):
    """core/voxel of core/voxel/CMakeFiles/mosbench_voxel.dir/raycast.cpp.o"""
    return target.split("/CMakeFiles/")[0]


def main():
    parser = argparse.ArgumentParser(description=__doc__, epilog=EXAMPLES,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--most", type=float, help="CPU seconds; exit code 1 above them")
    parser.add_argument("--target", default="mosbench", help="what is built (default: mosbench)")
    options, definitions = parser.parse_known_args()
    if any(not definition.startswith("-D") for definition in definitions):
        parser.error(f"{' '.join(definitions)}: expected -DNAME=VALUE")
    with tempfile.TemporaryDirectory() as build:
        log = pathlib.Path(build) / "compile.log"
        environment = {**os.environ, LOG: str(log)}
        configure = ["cmake", "-S", str(ROOT), "-B", build, "-G", "Ninja",
                     "-DCMAKE_BUILD_TYPE=Release", "-DMOSBENCH_BUILD_TESTS=OFF",
                     "-DMOSBENCH_BUILD_BENCH=OFF", "-DMOSBENCH_WITH_PCL=OFF",
                     "-DMOSBENCH_PRECOMPILED_HEADERS=ON", "-DMOSBENCH_WITH_ROSBAG=OFF", "-DMOSBENCH_WITH_HDF5=OFF",
                     f"-DCMAKE_CXX_COMPILER_LAUNCHER={sys.executable};{__file__}", *definitions]
        for command in (configure, ["cmake", "--build", build, "-j1", "--target", options.target]):
            done = subprocess.run(command, env=environment, capture_output=True, text=True)
            if done.returncode != 0:
                print(done.stdout[-4000:] + done.stderr[-4000:], file=sys.stderr)
                return 3
        rooms = collections.Counter()
        for line in log.read_text().splitlines():
            seconds, target = line.split(" ", 1)
            rooms[room_of(target)] += float(seconds)
    for room, seconds in rooms.most_common():
        print(f"{seconds:8.1f} s  {room}")
    total = sum(rooms.values())
    print(f"{total:8.1f} s  CPU time of compiling {options.target}")
    return 1 if options.most is not None and total > options.most else 0


if __name__ == "__main__":
    if LOG in os.environ:
        sys.exit(launch(sys.argv[1:]))
    sys.exit(main())
