#!/usr/bin/env python3
"""Measures how the cost of a scan grows with range, voxel size, beams and threads.

Simulates a drive on the highway with an OS2-128, leaves fewer beams of it (what the others saw is
missing returns, which cost next to nothing), profiles the method over it one setting at a time and
prints a table with the exponent b of cost = a * setting^b, fitted to the medians. --write puts the
table between the sweep marks of bench/NOTES.md and the plot into results/sweep.svg. --methods
measures every method at the middle setting instead, a row each with its memory; --write puts that
between the methods marks.
"""

import argparse
import json
import math
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
BASE = {"range": 50, "voxel": 0.25, "beams": 64, "threads": 1}
SWEEPS = {"range": [20, 50, 80, 120], "voxel": [0.1, 0.2, 0.3, 0.4], "beams": [16, 32, 64, 128],
          "threads": [1, 2]}
TITLES = {"range": "range, m", "voxel": "voxel size, m", "beams": "beams of 1,024 points",
          "threads": "threads (wall time)"}
# Edge of a voxel of each method in --methods; dufomap's is its own, the others at the end have none.
METHODS = {"hmm-mos": 0.25, "hmm-mos-plus": 0.25, "dynablox": 0.25, "lc-free-space": 0.25, "octomap": 0.25,
           "dufomap": 0.1, "underwood": None, "yoon": None}
VOXEL_SETTINGS = {"dufomap": "resolution_m", "underwood": None, "yoon": None}
SENSOR, SENSOR_BEAMS, WARM_UP_SCANS = "os2-128", 128, 5


def arguments():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(ROOT / "build/release/eval/mosbench"))
    parser.add_argument("--method", default="hmm-mos", help="to measure (default: hmm-mos)")
    parser.add_argument("--scans", type=int, default=30, help="of the drive (default: 30)")
    parser.add_argument("--rounds", type=int, default=3, help="over all settings (default: 3)")
    parser.add_argument("--methods", action="store_true", help="a row for every method, at the middle setting")
    parser.add_argument("--write", action="store_true", help="into bench/NOTES.md and results/sweep.svg")
    chosen = parser.parse_args()
    if chosen.rounds < 1:
        parser.error("--rounds: expected at least 1")
    if chosen.scans <= WARM_UP_SCANS:
        parser.error(f"--scans: expected more than {WARM_UP_SCANS}")
    return chosen


def simulate(program, scans, folder):
    """Writes a drive with all beams to folder/whole and returns the folder of its scans."""
    whole = folder / "whole"
    command = [program, "simulate", "--seed", "1", "--out", whole]
    subprocess.run([*command, "--layout", "doals", "--scene", "highway", "--scans", "1"], check=True,
                   stdout=subprocess.DEVNULL)
    scene = json.loads((whole / "scene.json").read_text())
    scene["sensor"] = SENSOR
    (folder / "scene.json").write_text(json.dumps(scene))
    shutil.rmtree(whole)
    # The layout of DOALS keeps the rays without return, so that points lie in columns of beams.
    subprocess.run([*command, "--layout", "doals", "--scene", folder / "scene.json", "--scans",
                    str(scans)], check=True, stdout=subprocess.DEVNULL)
    return next(whole.glob("**/velodyne")).parent


def profile(program, method, drive, report, setting):
    settings = [f"max_range_m={setting['range']}"]
    voxel_setting = VOXEL_SETTINGS.get(method, "voxel_size_m")
    if voxel_setting:
        settings.append(f"{voxel_setting}={setting['voxel']}")
    subprocess.run([program, "profile", drive, "--dataset", "semantickitti",
                    "--perturb", f"beams={setting['beams']},beams_of={SENSOR_BEAMS}", "--method", method,
                    "--threads", str(setting["threads"]), "--json", report, "--set", *settings],
                   check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return json.loads(report.read_text())


def cost_ms(report, variable):
    """Median milliseconds of the method per scan: CPU, or wall where threads differ."""
    kind = "wall" if variable == "threads" else "cpu"
    scans = report["sequences"][0]["scans"][WARM_UP_SCANS:]
    return statistics.median(scan[f"method_{kind}_ms"] for scan in scans)


def exponent(values, costs):
    """Slope of the least-squares line through the logarithms."""
    x, y = [math.log(v) for v in values], [math.log(c) for c in costs]
    mean_x, mean_y = statistics.fmean(x), statistics.fmean(y)
    return (sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y))
            / sum((a - mean_x) ** 2 for a in x))


def measure(program, method, scans, rounds):
    """The least of the medians of several rounds, each round over all settings, and the machine."""
    costs = {(variable, value): [] for variable, values in SWEEPS.items() for value in values}
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        drive = simulate(program, scans, folder)
        for turn in range(rounds):
            for (variable, value), found in costs.items():
                report = profile(program, method, drive, folder / "profile.json",
                                 {**BASE, variable: value})
                found.append(cost_ms(report, variable))
            print(f"round {turn + 1}/{rounds}", file=sys.stderr, flush=True)
    rows = {variable: (values, [min(costs[variable, value]) for value in values])
            for variable, values in SWEEPS.items()}
    return rows, report["machine"]["processor"]


def growth(variable, values, costs):
    if variable == "threads":
        return f"{costs[0] / costs[-1]:.2f} times as fast with {values[-1]}"
    return f"cost ~ {variable}^{exponent(values, costs):.2f}"


def table(rows, machine, scans, rounds):
    lines = [f"Simulated highway, {scans} scans (the map is still filling), {machine}: milliseconds per scan of the "
             "method alone,", f"CPU time, or wall time in the row of threads; the lowest of {rounds} medians. While one "
             f"is varied, the others stay at {BASE['range']} m, {BASE['voxel']} m, {BASE['beams']} beams, "
             f"{BASE['threads']} thread.", "",
             "| swept | settings | ms per scan | growth |", "|---|---|---|---|"]
    for variable, (values, costs) in rows.items():
        lines.append(f"| {TITLES[variable]} | {', '.join(map(str, values))} | "
                     f"{', '.join(f'{c:.1f}' for c in costs)} | {growth(variable, values, costs)} |")
    return "\n".join(lines)


def panel(left, title, values, costs):
    """One plot of 220 x 180 on logarithmic axes."""
    x_of = lambda v: left + 40 + 150 * math.log(v / values[0]) / math.log(values[-1] / values[0])
    low, high = min(costs) / 1.3, max(costs) * 1.3
    y_of = lambda c: 160 - 120 * math.log(c / low) / math.log(high / low)
    points = " ".join(f"{x_of(v):.1f},{y_of(c):.1f}" for v, c in zip(values, costs))
    parts = [f'<text x="{left + 115}" y="20" class="title">{title}</text>',
             f'<polyline points="{points}"/>']
    for value, cost in zip(values, costs):
        parts.append(f'<circle cx="{x_of(value):.1f}" cy="{y_of(cost):.1f}" r="3"/>'
                     f'<text x="{x_of(value):.1f}" y="178">{value}</text>'
                     f'<text x="{x_of(value):.1f}" y="{y_of(cost) - 8:.1f}">{cost:.1f}</text>')
    return "".join(parts)


def plot(rows):
    panels = "".join(panel(220 * i, TITLES[name], values, costs)
                     for i, (name, (values, costs)) in enumerate(rows.items()))
    return ('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 880 190" font-family="sans-serif" '
            'font-size="11"><style>text{text-anchor:middle;fill:#444}.title{font-weight:bold}'
            'polyline{fill:none;stroke:#0072b2;stroke-width:2}circle{fill:#0072b2}</style>'
            f'<rect width="880" height="190" fill="#fff"/>{panels}</svg>\n')


def memory_mb(report):
    """Most that the method held after a scan, and the process."""
    scans = report["sequences"][0]["scans"]
    return max(scan["method_bytes"] for scan in scans) / 1e6, max(scan["resident_mib"] for scan in scans) * 1.048576


def measure_methods(program, scans, rounds):
    """The least of the medians of several rounds, each round over all methods, their memory, and the machine."""
    costs, memory = {method: [] for method in METHODS}, {}
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        drive = simulate(program, scans, folder)
        for turn in range(rounds):
            for method, voxel in METHODS.items():
                report = profile(program, method, drive, folder / "profile.json", {**BASE, "voxel": voxel})
                costs[method].append(cost_ms(report, "range"))
                memory[method] = memory_mb(report)
            print(f"round {turn + 1}/{rounds}", file=sys.stderr, flush=True)
    return {method: min(found) for method, found in costs.items()}, memory, report["machine"]["processor"]


def methods_table(costs, memory, machine, scans, rounds):
    lines = [f"The same drive at {BASE['range']} m, {BASE['beams']} beams, 1 thread, {scans} scans, {machine}: CPU "
             f"milliseconds per scan of the method", f"alone, the lowest of {rounds} medians, and the most that it and "
             "the whole process held.", "",
             "| method | voxel, m | ms per scan | MB of the method | MB of the process |", "|---|---|---|---|---|"]
    for method, cost in costs.items():
        voxel = METHODS[method] or "none"
        lines.append(f"| {method} | {voxel} | {cost:.1f} | {memory[method][0]:.1f} | {memory[method][1]:.0f} |")
    return "\n".join(lines)


def write(name, text):
    """Replaces what bench/NOTES.md has between two marks."""
    notes = ROOT / "bench/NOTES.md"
    content = notes.read_text()
    begin, end = (f"<!-- {name} {edge} -->" for edge in ("begins", "ends"))
    if content.count(begin) != 1 or content.count(end) != 1:
        sys.exit(f"{notes}: lacks the {name} marks, expected {begin} and {end} once each")
    before, rest = content.split(begin)
    after = rest.split(end)[1]
    notes.write_text(f"{before}{begin}\n{text}\n{end}{after}")


def main():
    chosen = arguments()
    if chosen.methods:
        found = measure_methods(chosen.program, chosen.scans, chosen.rounds)
        text = methods_table(*found, chosen.scans, chosen.rounds)
        print(text)
        if chosen.write:
            write("methods", text)
        return
    rows, machine = measure(chosen.program, chosen.method, chosen.scans, chosen.rounds)
    text = table(rows, machine, chosen.scans, chosen.rounds)
    print(text)
    if chosen.write:
        (ROOT / "results/sweep.svg").write_text(plot(rows))
        write("sweep", f"{text}\n\n![cost per scan](../results/sweep.svg)")


if __name__ == "__main__":
    main()
