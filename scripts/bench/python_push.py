#!/usr/bin/env python3
"""Measures what pushing scans from Python costs beside the method in the program.

Labels the same scans alternately by `mosbench profile` and by `MOS.push`, one thread each, and compares the
CPU time of the method per scan, the least of all rounds. PYTHONPATH must name build/release/python."""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile
import time

import mosbench


def push_ms(sequence, config, columns):
    """Returns the mean CPU time of a push of points that were just read, as those of the program are."""
    mos = mosbench.MOS(config, scan_count=len(sequence))
    spent_s = 0.0
    for scan in sequence:
        points = scan.points if columns == 4 else scan.points[:, :columns].copy()
        start_s = time.thread_time()
        mos.push(points, scan.pose)
        spent_s += time.thread_time() - start_s
    return 1e3 * spent_s / len(sequence)


def program_ms(program, data):
    """Returns the mean CPU time of the method per scan."""
    command = [program, "profile", data, "--threads", "1", "--preset", "semantickitti", "--json", "-"]
    profile = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
    return profile["sequences"][0]["stages"]["method"]["cpu_ms"]["mean"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?", default="build/release/eval/mosbench")
    parser.add_argument("--scans", type=int, default=40)
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--most", type=float, help="largest ratio to the program; exit code 1 above it")
    options = parser.parse_args()
    config = mosbench.Config.preset("semantickitti")
    with tempfile.TemporaryDirectory() as folder:
        data = mosbench.simulate(pathlib.Path(folder, "data"), scene="highway", scans=options.scans)
        sequence = mosbench.open(data)
        ways = {
            "program": lambda: program_ms(options.program, data),
            "push of (N, 4)": lambda: push_ms(sequence, config, 4),
            "push of (N, 3)": lambda: push_ms(sequence, config, 3),
        }
        rounds = [{name: way() for name, way in ways.items()} for _ in range(options.rounds)]
    least_ms = {name: min(one[name] for one in rounds) for name in ways}
    ratios = {name: value / least_ms["program"] for name, value in least_ms.items()}
    for name, value in least_ms.items():
        print(f"{name:15}{value:8.3f} ms of CPU time per scan, ratio {ratios[name]:.3f}")
    return 1 if options.most is not None and max(ratios.values()) > options.most else 0


if __name__ == "__main__":
    sys.exit(main())
