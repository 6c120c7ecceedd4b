#!/usr/bin/env python3
"""Adds a method, a data set, a metric, a protocol and a reading option to a copy of the project, each with two files at most.

additions.py            applies the changes
additions.py --build    also compiles the program, prints its CPU seconds, and uses what was added"""

import argparse
import json
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PATCHES = ROOT / "tests/examples/additions"
# The method is the one that add_a_method.cpp shows.
COPIED = {"method": ("tests/examples/new_voxels.hpp", "core/methods/new_voxels/pipeline.hpp")}
ADDITIONS = ("method", "data_set", "metric", "protocol", "reading_option")
MOST_FILES = 2


def copy_project(target):
    """Copies what git tracks."""
    names = subprocess.run(["git", "ls-files"], cwd=ROOT, check=True, capture_output=True, text=True).stdout.split("\n")
    for name in filter(None, names):
        (target / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / name, target / name)


def add(addition, project):
    """Applies an addition and returns the files that it touches."""
    patch = PATCHES / f"{addition}.patch"
    touched = re.findall(r"^\+\+\+ b/(.+)$", patch.read_text(), flags=re.MULTILINE)
    # Within another repository git would skip files without a word.
    environment = {**os.environ, "GIT_CEILING_DIRECTORIES": str(project.parent)}
    subprocess.run(["git", "apply", "-C1", str(patch)], cwd=project, env=environment, check=True)
    if addition in COPIED:
        source, target = COPIED[addition]
        (project / target).parent.mkdir()
        shutil.copy2(project / source, project / target)
        touched.append(target)
    assert 1 <= len(touched) <= MOST_FILES, f"{addition} touches {touched}"
    return touched


def call(*command):
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True)
    assert done.returncode == 0, f"{command}: {done.stdout[-4000:]}{done.stderr}"
    return done.stdout


def compile_program(project, build):
    """Compiles the program without PCL, ROS and HDF5 from nothing, and prints the CPU seconds of that."""
    off = ("BUILD_TESTS", "BUILD_BENCH", "WITH_PCL", "WITH_ROSBAG", "WITH_HDF5")
    on = ("PRECOMPILED_HEADERS", "WARNINGS_AS_ERRORS")
    call("cmake", "-S", project, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
         *(f"-DMOSBENCH_{name}=OFF" for name in off), *(f"-DMOSBENCH_{name}=ON" for name in on))
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    call("cmake", "--build", build, "-j", os.cpu_count(), "--target", "mosbench")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(f"compiled in {after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime:.0f} CPU seconds")


def use_all(program, folder):
    """Simulates a sequence, gives it the data set's name for poses, and judges it by all that was added."""
    simulated = folder.with_name("simulated")
    call(program, "simulate", "--layout", "semantickitti", "--scene", "street", "--scans", 8, "--seed", 1,
         "--out", simulated)
    # What says that this was simulated as SemanticKITTI stays behind.
    shutil.move(simulated / "sequences", folder)
    for poses in folder.glob("*/poses.txt"):
        poses.rename(poses.with_name("lab_poses.txt"))
    asked = ("run", folder, "--method", "new-voxels", "--protocol", "near", "--json")
    read_as_it_is = json.loads(call(program, *asked, "--out", folder / "out"))
    raised = json.loads(call(program, *asked, "--read", "raise_m=0.1", "--out", folder / "raised"))
    summary = read_as_it_is["sequences"][0]["summary"]
    assert summary["iou"] <= summary["f1"] and 0 < summary["f2"] <= 1, summary
    text = json.dumps(read_as_it_is)
    for name in ('"new-voxels"', '"near"', '"lab"'):
        assert name in text, f"{name} is not in {text}"
    assert raised["sequences"][0]["summary"] != summary
    assert "raise_m" in (folder / "raised/08/result.json").read_text()
    assert "raise_m" in call(program, "run", "--help-all")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", action="store_true", help="compile the program and use what was added")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        project, build = pathlib.Path(temporary) / "mosbench", pathlib.Path(temporary) / "build"
        copy_project(project)
        for addition in ADDITIONS:
            print(addition, *add(addition, project))
        if options.build:
            compile_program(project, build)
            use_all(build / "eval/mosbench", pathlib.Path(temporary) / "drive")
    return 0


if __name__ == "__main__":
    sys.exit(main())
