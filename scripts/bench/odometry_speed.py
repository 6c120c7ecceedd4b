#!/usr/bin/env python3
"""Measures what odometry costs per scan, engines in turn.

    scripts/bench/odometry_speed.py SEQUENCE[:MIN_M,MAX_M]... [--rounds N] [--numeric]

Runs `mosbench odometry --threads 1` on every sequence with every engine, one after the other and all of
them again in every round, so that what else the machine does meets all of them alike. Prints per sequence
and engine the median of the CPU time per scan (user and system, of the whole program: start and reading
included) with its range over the rounds, and the median over the rounds of its ratio to the first engine.
The row "start and reading" is of a call that registers nothing, as no point is within its range limits.
--numeric adds SiMpLE with the authors' numeric gradient, which takes ten times as long.
"""

import argparse
import pathlib
import resource
import statistics
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
ENGINES = {"SiMpLE": ["--odometry", "simple"], "KISS-ICP": ["--odometry", "kiss"]}
READING = "start and reading"
NUMERIC = {"SiMpLE, gradient=numeric": ["--odometry", "simple", "--set", "gradient=numeric"]}


def cpu_ms_per_scan(program, sequence, limits, engine, out):
    """Exit code 1 says that poses are doubtful."""
    words = [program, "odometry", sequence, "-o", out, "--overwrite", "--threads", "1", *engine]
    if limits:
        least_m, most_m = limits.split(",")
        words += ["--set", f"min_range_m={least_m},max_range_m={most_m}"]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(words, capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode > 1:
        raise SystemExit(done.stderr)
    cpu_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return 1000 * cpu_s / len(out.read_text().splitlines())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sequences", nargs="+", help="folders, each with the range limits of its sensor")
    parser.add_argument("--program", default=str(ROOT / "build/release/eval/mosbench"))
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--numeric", action="store_true")
    chosen = parser.parse_args()
    engines = ENGINES | (NUMERIC if chosen.numeric else {}) | {READING: []}
    first = next(iter(engines))
    times = {}
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(chosen.rounds):
            for sequence in chosen.sequences:
                place, _, limits = sequence.partition(":")
                for name, engine in engines.items():
                    asked = "999,1000" if name == READING else limits
                    out = pathlib.Path(folder) / "poses.txt"
                    ms = cpu_ms_per_scan(chosen.program, place, asked, engine, out)
                    times.setdefault((pathlib.Path(place).name, name), []).append(ms)
    print("| sequence | engine | CPU ms per scan | least to most | ratio |\n|---|---|---|---|---|")
    for (sequence, engine), ms in times.items():
        ratio = statistics.median(a / b for a, b in zip(ms, times[sequence, first]))
        print(f"| {sequence} | {engine} | {statistics.median(ms):.1f} | {min(ms):.1f} to {max(ms):.1f} | {ratio:.2f} |")


if __name__ == "__main__":
    main()
