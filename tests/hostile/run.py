#!/usr/bin/env python3
"""Hostile rounds: damaged inputs, kills, races and limits, each against a program that must survive them.

run.py --minutes 5 | --hours 1 [--cases N] [--jobs N] [--seed N] PROGRAM
run.py --seed N --case DRIVER:K PROGRAM        repeats one case
"""

import argparse
import collections
import multiprocessing
import multiprocessing.connection
import os
import pathlib
import re
import shlex
import shutil
import sys
import tempfile
import time
import traceback  # noqa: F401  Python's own modules may be out of reach for nobody, whose rights a worker has
from dataclasses import dataclass, field
from random import Random

import fixtures
import folders
import killer
import limits
import mutate
import program
import races
import sandbox

# Each driver with its part of the time.
DRIVERS = {driver.NAME: (driver, part) for driver, part in
           ((killer, 0.15), (races, 0.1), (limits, 0.15), (mutate, 0.6))}
COLUMNS = ("crashes", "hangs", "damaged", "numbers")
KEPT_OF_A_SORT = 2
ROOT = pathlib.Path(__file__).resolve().parents[2]


@dataclass
class Tried:
    """What one case found."""

    kind: str
    words: list
    code: int
    faults: list
    processes: int
    hit: bool
    case: str = ""
    kept: str = ""


@dataclass
class Bench:
    """What the drivers share: the program, good inputs, and a folder for one case."""

    program: pathlib.Path
    scratch: str
    published: bytes
    full_device: int = -1
    small_disk: str = ""
    trees: dict = field(default_factory=dict)
    case: str = ""

    def renew(self, tree):
        folders.renew(self.case, tree)

    def run(self, line):
        return program.run(self.program, line.split(), self.case)

    def tried(self, kind, ended, faults, processes=1, hit=False):
        return Tried(kind, ended.words, ended.code, faults, processes, hit)


def prepare(bench):
    bench.case = os.path.join(bench.scratch, "first/a/b/c/case")
    os.makedirs(os.path.dirname(bench.case))
    bench.trees = fixtures.make(bench.program, bench.case)
    for driver, _ in DRIVERS.values():
        driver.prepare(bench)


def attempt(bench, driver, seed, number):
    tried = driver.try_case(bench, Random(f"{seed}:{driver.NAME}:{number}"))
    tried.case = f"{driver.NAME}:{number}"
    return tried


def keep(bench, tried, folder):
    """Keeps a case's folder, what its command printed, and the command."""
    place = pathlib.Path(folder) / tried.case.replace(":", "-")
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir(parents=True)
    shutil.copytree(bench.case, place / "case", symlinks=True, ignore=lambda top, names: [
        name for name in names if not (os.path.isdir(os.path.join(top, name)) or os.path.isfile(os.path.join(top, name)))])
    for stream in ("out", "err"):
        shutil.copy(f"{bench.case}.{stream}", place / stream)
    sentences = "".join(f"# {column}: {sentence}\n" for column, sentence in tried.faults)
    (place / "command.sh").write_text(
        f"{sentences}cd case && {shlex.join([str(bench.program), *tried.words])}\n", errors="surrogateescape")
    return str(place)


def sort_of(tried):
    """Defects of one sort differ only in numbers and names."""
    column, sentence = tried.faults[0]
    return tried.case.split(":")[0], tried.kind, column, re.sub(r"[^a-zA-Z ]", "", sentence)[:60]


def work(bench, number, jobs, seed, plan, folder, answers):
    """One of the processes that try cases until there are no more or their time is over."""
    sandbox.enter(bench, number)
    seen = collections.Counter()
    for driver, until, cases in plan:
        case = number
        while case < cases and time.monotonic() < until:
            tried = attempt(bench, driver, seed, case)
            if tried.faults:
                seen[sort_of(tried)] += 1
                if seen[sort_of(tried)] <= KEPT_OF_A_SORT:
                    tried.kept = keep(bench, tried, folder)
            answers.send(tried)
            case += jobs
    answers.close()


def answers_of(connections):
    """What the workers send, until the last of them is done; None every second without an answer."""
    while connections:
        ready = multiprocessing.connection.wait(connections, timeout=1)
        for connection in ready:
            try:
                yield connection.recv()
            except EOFError:
                connections.remove(connection)
        if not ready:
            yield None


class Tally:
    """Counts by driver."""

    def __init__(self):
        self.rows = {name: collections.Counter() for name in DRIVERS}
        self.codes = collections.Counter()
        self.sorts = {}

    def add(self, tried):
        row = self.rows[tried.case.split(":")[0]]
        row["tried"] += 1
        row["processes"] += tried.processes
        row["hits"] += tried.hit
        row["survived"] += not tried.faults
        for column in {column for column, _ in tried.faults}:
            row[column] += 1
        self.codes[tried.code] += 1
        if not tried.faults:
            return
        if (sort := sort_of(tried)) not in self.sorts:
            self.sorts[sort] = 0
            print(f"DEFECT {tried.case} ({tried.kind}): {shlex.join(tried.words)}".encode("ascii", "replace").decode())
            for column, sentence in tried.faults:
                print(f"  {column}: {sentence[:300]!r}")
            print(f"  kept in {tried.kept}", flush=True)
        self.sorts[sort] += 1

    def processes(self):
        return sum(row["processes"] for row in self.rows.values())

    def print(self):
        columns = ("processes", "tried", "hits", "survived", *COLUMNS)
        print(f"{'driver':<8}" + "".join(f"{column:>11}" for column in columns))
        for name, row in self.rows.items():
            print(f"{name:<8}" + "".join(f"{row[column]:>11}" for column in columns))
        ends = ", ".join(f"{count} with {code}" for code, count in sorted(self.codes.items()))
        print(f"ends: {ends}; sorts of defects: {len(self.sorts)}")


def hostile_round(bench, arguments, seconds):
    """Runs all drivers one after the other, each with its part of the time and of the cases. Returns the counts."""
    plan, until = [], time.monotonic()
    for driver, part in DRIVERS.values():
        until += part * seconds
        plan.append((driver, until, part * arguments.cases))
    connections, workers = [], []
    for number in range(arguments.jobs):
        receiving, sending = multiprocessing.Pipe(duplex=False)
        workers.append(multiprocessing.Process(target=work, daemon=True, args=(
            bench, number, arguments.jobs, arguments.seed, plan, arguments.keep, sending)))
        workers[-1].start()
        sending.close()
        connections.append(receiving)
    tally, next_line = Tally(), 0.0
    for tried in answers_of(connections):
        if tried:
            tally.add(tried)
        if time.monotonic() >= next_line:
            next_line = time.monotonic() + 15
            left = max(0, until - time.monotonic())
            print(f"{tally.processes()} processes, {len(tally.sorts)} sorts of defects, {left:.0f} s left", flush=True)
    for worker in workers:
        worker.join()
        if worker.exitcode:
            sys.exit("run.py: a driver failed")
    return tally


def repeat(bench, arguments):
    """Runs one case in a process of its own, and says what it found."""
    name, number = arguments.case.split(":")
    sandbox.enter(bench, 0)
    tried = attempt(bench, DRIVERS[name][0], arguments.seed, int(number))
    print(f"{tried.case} ({tried.kind}): {shlex.join(tried.words)}: exit code {tried.code}")
    for column, sentence in tried.faults:
        print(f"  {column}: {sentence}")
    print(f"kept in {keep(bench, tried, arguments.keep)}")
    sys.exit(1 if tried.faults else 0)


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    duration = parser.add_mutually_exclusive_group(required=True)
    duration.add_argument("--minutes", type=float)
    duration.add_argument("--hours", type=float)
    duration.add_argument("--case", metavar="DRIVER:K", help="repeat this case alone")
    parser.add_argument("--cases", type=float, default=float("inf"), help="at most so many; no limit by default")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", default=ROOT / "build/hostile", help="folder for the cases that find a defect")
    parser.add_argument("program", metavar="PROGRAM", type=lambda path: pathlib.Path(path).resolve())
    return parser.parse_args()


def main():
    arguments = parse_arguments()
    published = (ROOT / "results/published.csv").read_bytes()
    in_memory = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None
    with tempfile.TemporaryDirectory(prefix="hostile-", dir=in_memory, ignore_cleanup_errors=True) as scratch:
        os.chmod(scratch, 0o755)
        bench = Bench(arguments.program, scratch, published)
        try:
            prepare(bench)
        except fixtures.NotWhole as error:
            print(f"run.py: {error}", file=sys.stderr)
            return 2
        sandbox.share(arguments.keep)
        if arguments.case:
            alone = multiprocessing.Process(target=repeat, args=(bench, arguments))
            alone.start()
            alone.join()
            return alone.exitcode
        tally = hostile_round(bench, arguments, 60 * (arguments.minutes or 60 * arguments.hours))
    tally.print()
    cases = sum(row["tried"] for row in tally.rows.values())
    if cases < arguments.cases < float("inf"):
        print(f"the time was over after {cases} of {arguments.cases:.0f} cases")
    whole = all(row["tried"] for row in tally.rows.values())
    return 0 if whole and not tally.sorts else 1


if __name__ == "__main__":
    sys.exit(main())
