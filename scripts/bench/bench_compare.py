#!/usr/bin/env python3
"""Says whether one build of mosbench is slower than another, on a machine that others use, too.

Both programs run the same command alternately, A B B A B A A B ..., so that other load on the machine
affects both alike. The CPU times of the whole processes are compared. The ratio within a pair cancels
how busy the machine was; the median of the ratios' logarithms is taken, with a confidence interval from
order statistics, which no single bad pair can move.

Exit codes: 0 not slower, 1 slower by more than the threshold beyond doubt, 2 wrong usage, 3 a
program failed.
"""

import argparse
import math
import os
import subprocess
import sys
import tempfile

EXAMPLES = """examples:
  scripts/bench/bench_compare.py old/mosbench build/release/eval/mosbench
  scripts/bench/bench_compare.py --pairs 41 --threshold 3 old/mosbench new/mosbench -- \\
      run kitti/sequences/08 --threads 1 --out {out}
{out} becomes an empty folder for each run. Without a command a simulated sequence is segmented."""


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, epilog=EXAMPLES, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", help="program of the build to compare with")
    parser.add_argument("new", help="program of the build in question")
    parser.add_argument("--pairs", type=int, default=31, help="runs of each (default: 31, at least 6)")
    parser.add_argument("--threshold", type=float, default=3.0,
                        help="per cent by which the new one may be slower (default: 3)")
    parser.add_argument("--confidence", type=float, default=0.99,
                        help="of the interval, both sides together (default: 0.99)")
    parser.add_argument("command", nargs="*", help="after --: what both run")
    chosen = parser.parse_args()
    if chosen.pairs < 6:
        parser.error("--pairs: expected at least 6")
    if not 0.5 <= chosen.confidence < 1:
        parser.error("--confidence: expected 0.5 or more and below 1")
    if 2 ** (1 - chosen.pairs) > 1 - chosen.confidence:
        parser.error(f"--pairs: {chosen.pairs} cannot give {chosen.confidence:g} confidence, expected more")
    if chosen.threshold < 0:
        parser.error("--threshold: expected 0 or more")
    return chosen


def cpu_seconds(program, command):
    """User and system time of one run, reading and writing included."""
    with tempfile.TemporaryDirectory() as out:
        filled = [part.replace("{out}", out) for part in command]
        process = subprocess.Popen([program, *filled], stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        error = process.stderr.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise RuntimeError(f"{program}: exit code {process.returncode}, expected 0: "
                           f"{error.decode(errors='replace').strip()}")
    seconds = usage.ru_utime + usage.ru_stime
    if seconds == 0:
        raise RuntimeError(f"{program}: took no measurable time, expected a longer command")
    return seconds


def interval_ranks(count, confidence):
    """Ranks from 0 of the order statistics that enclose the median with at least this confidence."""
    tail = (1 - confidence) / 2
    below = 0.0
    for rank in range(count // 2 + 1):
        below += math.comb(count, rank) / 2 ** count
        if below > tail:
            return max(rank - 1, 0), count - 1 - max(rank - 1, 0)
    return 0, count - 1


def measured_ratios(chosen, command):
    ratios = []
    for pair in range(chosen.pairs):
        order = ["old", "new"] if pair % 4 in (0, 3) else ["new", "old"]
        seconds = {which: cpu_seconds(getattr(chosen, which), command) for which in order}
        ratios.append(seconds["new"] / seconds["old"])
        if sys.stderr.isatty():
            print(f"\rpair {pair + 1}/{chosen.pairs}", end="", file=sys.stderr, flush=True)
    if sys.stderr.isatty():
        print(file=sys.stderr)
    return ratios


def median_and_interval(ratios, confidence):
    ordered = sorted(ratios)
    low, high = interval_ranks(len(ordered), confidence)
    middle = math.sqrt(ordered[(len(ordered) - 1) // 2] * ordered[len(ordered) // 2])
    return middle, ordered[low], ordered[high]


def is_slower(low, threshold):
    """Whether even the lower end of the interval lies beyond the threshold, in per cent."""
    return low > 1 + threshold / 100


def main():
    chosen = arguments()
    for program in (chosen.old, chosen.new):
        if not (os.path.isfile(program) and os.access(program, os.X_OK)):
            print(f"{program}: cannot be run, expected a program", file=sys.stderr)
            return 2
    chosen.old, chosen.new = os.path.abspath(chosen.old), os.path.abspath(chosen.new)
    try:
        with tempfile.TemporaryDirectory() as simulated:
            command = chosen.command
            if not command:
                cpu_seconds(chosen.old, ["simulate", "--layout", "semantickitti", "--scene", "mall",
                                         "--scans", "40", "--seed", "1", "--out", simulated])
                command = ["run", simulated, "--threads", "1", "--out", "{out}/run"]
            for program in (chosen.old, chosen.new):  # the first run reads from the disk
                cpu_seconds(program, command)
            ratio, low, high = median_and_interval(measured_ratios(chosen, command),
                                                   chosen.confidence)
    except (RuntimeError, OSError) as error:
        print(error, file=sys.stderr)
        return 3
    slower = is_slower(low, chosen.threshold)
    verdict = "SLOWER" if slower else "not slower"
    print(f"new / old CPU time {ratio:.3f}, {chosen.confidence:.0%} interval {low:.3f} to {high:.3f} "
          f"from {chosen.pairs} pairs: {verdict} than {chosen.threshold:g} % allows")
    return 1 if slower else 0


if __name__ == "__main__":
    sys.exit(main())
