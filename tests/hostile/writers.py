"""Every command that writes files, with what it writes when nobody disturbs it."""

import json
import re
import time
from dataclasses import dataclass, field

import folders
import fixtures
import program

READERS = {"stats", "table", "rank", "compare", "doctor", "info", "trajectory", "list", "help"}
WRITERS = {
    "run": "run data --set @config.json --threads 1 --write scores --out out",
    "run on two threads": "run data --set @config.json --threads 2 --out out",
    "run with odometry": "run data --set @config.json --threads 1 --odometry kiss --out out",
    "run --overwrite": "run data --set @other.json --write scores --threads 1 --overwrite --out run",
    "score": "score data --predictions run --method one --out out",
    "simulate": "simulate --layout semantickitti --scene scene.json --scans 8 --seed 2 --threads 1 --out out",
    "simulate doals": "simulate --layout doals --scene scene.json --scans 8 --seed 2 --threads 2 --out out",
    "simulate opensceneflow": "simulate --layout opensceneflow --scene scene.json --scans 8 --seed 2 --threads 2 --out out",
    "simulate nuscenes": "simulate --layout nuscenes --scene scene.json --scans 8 --seed 2 --threads 2 --out out",
    "simulate helipr": "simulate --layout helipr --scene room --scans 8 --seed 2 --threads 2 --out out",
    "simulate kitti-raw": "simulate --layout kitti-raw --scene scene.json --scans 8 --seed 2 --threads 2 --out out",
    "simulate kitti-tracking": "simulate --layout kitti-tracking --scene scene.json --scans 8 --seed 2 --threads 2 --out out",
    "report": "report run -o old.html",
    "report of numbers": "report run other_run -o old.html --scans none",
    "render": "render run --scan 7 -o old.png --size 200",
    "render of several scans": "render run --scans 3-5 -o pictures --size 200",
    "curve": "stats run --by threshold -o old.png",
    "reproduce": "run table:I --data doals --threads 1 --out out",
    "profile": "profile data --json p.json -o t.json",
    "truth": "truth propose data --threads 1 -o out",
    "map": "map data --method hmm-mos --set @config.json --threads 1 --out out -o made.ply,made.yaml",
    "convert": "convert data --layout semantickitti --out out",
    "convert to doals": "convert data --layout doals --out out",
    "convert to ROS 2": "convert data --layout ros2-mcap --out out",
    "convert to a database of ROS 2": "convert data --layout ros2-db3 --out out",
    "convert to OpenSceneFlow": "convert data --layout opensceneflow --out out",
    "study": "rank study.yaml --out out --as html -o old.html",
    "convert to a bag": "convert data --layout doals-bag --out out",
    "bless": "compare baseline three --accept --even-if",
    "bless anew": "compare out three --accept",
    "odometry": "odometry data --threads 1 -o old.txt --overwrite",
}
BY_THE_CLOCK = {"p.json", "t.json"}
OLD_FILES = {
    "old.html": b"<!doctype html>\nan old page of mosbench",
    "old.png": b"\x89PNG, an old picture",
    "old.txt": b"old poses",
}


@dataclass
class Writer:
    name: str
    words: list
    before: dict = field(repr=False)  # contents of the case's folder
    after: dict = field(repr=False)
    seconds: float


def three_sequences(result_tree):
    """The results of one sequence under three names, so that half of them can be lost."""
    tree = {}
    for name in ("06", "07", "08"):
        result = json.loads(result_tree["08/result.json"])
        tree[f"{name}/result.json"] = json.dumps({**result, "sequence": name}, indent=1).encode()
    return tree


def tree_of(trees):
    tree = dict(trees["texts"]) | OLD_FILES
    for name, place in (("semantickitti", "data"), ("doals", "doals"), ("run", "run"), ("other_run", "other_run")):
        tree |= folders.at(place, trees[name])
    tree |= folders.at("baseline", three_sequences(trees["other_run"]))
    return tree | folders.at("three", three_sequences(trees["run"]))


def contents(case):
    """What is in a case's folder; a file that holds measured times counts as its first byte, if it is JSON."""
    found = folders.contents(case)
    for name in BY_THE_CLOCK & found.keys():
        try:
            found[name] = type(json.loads(found[name])).__name__
        except ValueError:
            found[name] = "cut off"
    return found


def check_that_all_are_here(bench):
    """A command that is new belongs into one of the two lists."""
    bench.renew({})
    listed = bench.run("--help").out.partition("\nCommands:\n")[2].partition("\n\n")[0]
    commands = set(re.findall(r"^  ([\w-]+)", listed, re.MULTILINE))
    known = READERS | {line.split()[0] for line in WRITERS.values()}
    if commands != known:
        raise fixtures.NotWhole(f"commands that writers.py does not know, or that are gone: {commands ^ known}")


def measure(bench):
    """Runs every command undisturbed."""
    check_that_all_are_here(bench)
    tree = tree_of(bench.trees)
    measured = []
    for name, line in WRITERS.items():
        bench.renew(tree)
        before = contents(bench.case)
        start = time.monotonic()
        ended = bench.run(line)
        seconds = time.monotonic() - start
        if ended.code not in (0, 1) or program.fault_of(ended):
            raise fixtures.NotWhole(f"mosbench {line}: exit code {ended.code}: {ended.err}")
        after = contents(bench.case)
        if after == before or "cut off" in after.values():
            raise fixtures.NotWhole(f"mosbench {line}: wrote nothing, or no JSON")
        measured.append(Writer(name, line.split(), before, after, seconds))
    return measured


def half_written(writer, found):
    """A sentence about a file that is neither the old nor the new one; None when all are whole."""
    for name, data in found.items():
        if re.search(folders.UNFINISHED, name) or data in (writer.before.get(name), writer.after.get(name)):
            continue
        return f"{name} is neither as before nor as it should be"
    lost = [name for name in writer.before if name in writer.after and name not in found]
    if lost:
        return f"{lost[0]} was lost"
    if writer.name == "bless":
        parts = [{name: data for name, data in each.items() if name.startswith("baseline/")}
                 for each in (found, writer.before, writer.after)]
        if _whole(parts[0]) not in map(_whole, parts[1:]):
            return "the baseline is a mixture of old and new"
    return None


def _whole(tree):
    return {name: data for name, data in tree.items() if not re.search(folders.UNFINISHED, name)}
