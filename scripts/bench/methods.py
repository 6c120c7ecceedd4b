#!/usr/bin/env python3
"""Runs every method on simulated sequences of every sensor, and prints the tables of docs/history/methods.md.

    scripts/bench/methods.py --work FOLDER [--scans N] [--seeds 1,2,3]

Sequences and results stay in FOLDER; the same command runs what is missing. Simulated numbers show
that the methods work and what they cost, not how good they are on real data: poses are perfect, and
all movers are rigid boxes and people of a few kinds. A seed changes the noise alone.
"""

import argparse
import json
import pathlib
import shutil
import statistics
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
# scene, sensor
KINDS = [("mall", "os1-64"), ("street", "hdl-64e"), ("campus", "vlp-16"), ("campus", "avia"),
         ("street", "aeva"), ("highway", "os2-128")]


def simulated(program, work, kind, seed, scans):
    """The folder of a simulated sequence, made when it is not there yet."""
    scene_name, sensor = kind
    name = f"{scene_name}-{sensor}-{seed}"
    folder = work / "sim" / name
    if folder.exists():
        return folder
    begun = work / "sim" / f"{name}.begun"
    shutil.rmtree(begun, ignore_errors=True)
    command = [program, "simulate", "--layout", "semantickitti", "--seed", str(seed), "--out", begun]
    subprocess.run([*command, "--scene", scene_name, "--scans", "1"], check=True, capture_output=True)
    scene = json.loads((begun / "scene.json").read_text()) | {"sensor": sensor}
    shutil.rmtree(begun)
    file = work / "sim" / f"{name}.json"
    file.write_text(json.dumps(scene))
    subprocess.run([*command, "--scene", file, "--scans", str(scans)], check=True, capture_output=True)
    begun.rename(folder)
    return folder


def measured(program, work, data):
    """The rows of the leaderboard of all methods on one sequence, with their CPU time."""
    out = work / "runs" / data.name
    subprocess.run([program, "run", data, "--method", "all", "--threads", "1", "--out", out],
                   check=True, stdout=subprocess.DEVNULL)
    rows = []
    for folder in sorted(folder for folder in out.iterdir() if folder.is_dir()):
        printed = subprocess.run([program, "rank", folder, "--format", "json"], check=True,
                                 stdout=subprocess.PIPE)
        row = json.loads(printed.stdout)["rows"][0]
        rows.append(row | {"cpu_ms": cpu_ms(program, work, data, folder.name)})
    return rows


def cpu_ms(program, work, data, method):
    """CPU milliseconds per scan once the start is over; a busy machine changes them little."""
    file = work / "profiles" / f"{data.name}-{method}.json"
    if not file.exists():
        subprocess.run([program, "profile", data, "--method", method, "--threads", "1", "--scans", "30",
                        "--json", file], check=True, stdout=subprocess.DEVNULL)
    scans = json.loads(file.read_text())["sequences"][0]["scans"]
    return statistics.fmean(scan["method_cpu_ms"] for scan in scans[10:])


def percent(row, metric):
    value = row["all"][metric]["value"]
    return None if value is None else 100 * value


def mean_text(rows, metric):
    values = [percent(row, metric) for row in rows]
    return "n/a" if None in values else f"{statistics.fmean(values):.1f}"


def mean(rows, value):
    return statistics.fmean(value(row) for row in rows)


def print_table(by_kind, methods, title, cell, of_all="mean"):
    """A row per method, best mean IoU first; a column per kind, and one of all."""
    print(f"\n### {title}\n")
    print("| method | " + " | ".join(f"{scene}, {sensor}" for scene, sensor in by_kind) + f" | {of_all} |")
    print("|---|" + "---|" * (len(by_kind) + 1))
    for method in methods:
        of_kinds = [[row for row in rows if row["method"] == method] for rows in by_kind.values()]
        cells = [cell(rows) for rows in [*of_kinds, sum(of_kinds, [])]]
        print(f"| {method} | {' | '.join(cells)} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(ROOT / "build/release/eval/mosbench"))
    parser.add_argument("--work", type=pathlib.Path, required=True, help="folder for sequences and results")
    parser.add_argument("--scans", type=int, default=40)
    parser.add_argument("--seeds", default="1,2,3")
    chosen = parser.parse_args()
    for folder in ("sim", "profiles"):
        (chosen.work / folder).mkdir(parents=True, exist_ok=True)
    by_kind = {kind: [] for kind in KINDS}
    for seed in map(int, chosen.seeds.split(",")):
        for kind in KINDS:
            data = simulated(chosen.program, chosen.work, kind, seed, chosen.scans)
            by_kind[kind] += measured(chosen.program, chosen.work, data)
    rows = sum(by_kind.values(), [])
    methods = sorted({row["method"] for row in rows},
                     key=lambda name: -mean([row for row in rows if row["method"] == name],
                                            lambda row: percent(row, "iou")))
    print_table(by_kind, methods, "Moving IoU in % (precision, recall)",
                lambda some: f"{mean_text(some, 'iou')} ({mean_text(some, 'precision')}, "
                             f"{mean_text(some, 'recall')})")
    print_table(by_kind, methods, "CPU milliseconds per scan, one thread, without reading",
                lambda some: f"{mean(some, lambda row: row['cpu_ms']):.1f}")
    print_table(by_kind, methods, "MB, most that the whole process held after a scan",
                lambda some: f"{max(row['memory_mb'] for row in some):.0f}", "highest")
    spreads = {}
    for kind, some in by_kind.items():
        for method in methods:
            ious = [percent(row, "iou") for row in some if row["method"] == method]
            spreads[max(ious) - min(ious)] = (method, *kind)
    print(f"\nSeeds differ most for {', '.join(spreads[max(spreads)])}: by {max(spreads):.1f} points.")


if __name__ == "__main__":
    main()
