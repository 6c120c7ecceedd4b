#!/usr/bin/env python3
"""Compares hmm-mos-plus with the paper's method on simulated sequences and on a real one.

    scripts/bench/plus_study.py --work FOLDER [--kitti SEQUENCE] [--delay N]

Simulates every sequence below into FOLDER (once), runs the methods on all of them and prints a
table. The defaults of hmm-mos-plus were chosen on the group "tuned"; those of "judged" have other
seeds and most other sensors. --kitti names a sequence in the layout of SemanticKITTI that
is judged, too; its numbers are real and stand apart.
"""

import argparse
import json
import pathlib
import random
import shutil
import statistics
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
ARRIVALS = ["--set", "min_seed_share=0.2,object_age_s=3,min_fresh_share=0,max_aged_share=1,"
            "min_rise_voxels=0,max_unknown_voxels=15"]
METHODS = {"paper": ["--method", "hmm-mos"],
           "arrivals": ["--method", "hmm-mos-plus", *ARRIVALS],
           "plus": ["--method", "hmm-mos-plus"]}
SKIPPED_REAL_SCANS = 4  # those that the paper's method does not judge
# group, name, scene, sensor, seed, scans, seconds per scan, pose noise (m, radians), voxel and range (m)
SEQUENCES = [
    ("tuned", "mall-os1", "mall", "os1-64", 11, 80, 0.1, (0, 0), 0.20, 20),
    ("tuned", "campus-avia", "campus", "avia", 12, 80, 0.1, (0, 0), 0.25, 50),
    ("tuned", "street-vlp16", "street", "vlp-16", 13, 80, 0.1, (0, 0), 0.25, 50),
    ("tuned", "street-hdl64-noisy", "street", "hdl-64e", 14, 60, 0.1, (0.02, 0.0017), 0.25, 50),
    ("tuned", "campus-os1", "campus", "os1-64", 15, 60, 0.1, (0.02, 0.0017), 0.25, 50),
    ("tuned", "parked-hdl64", "parked", "hdl-64e", 16, 60, 0.1, (0.03, 0.0026), 0.25, 50),
    ("tuned", "parked-vlp16", "parked", "vlp-16", 17, 60, 0.1, (0.03, 0.0026), 0.25, 50),
    ("tuned", "parked-os1-t1", "parked", "os1-64", 41, 50, 0.1, (0.03, 0.0026), 0.25, 50),
    ("tuned", "parked-os1-t2", "parked", "os1-64", 42, 50, 0.1, (0.03, 0.0026), 0.25, 50),
    ("tuned", "parked-hdl-t3", "parked", "hdl-64e", 43, 50, 0.1, (0.03, 0.0026), 0.25, 50),
    ("judged", "mall-os1-b", "mall", "os1-64", 21, 80, 0.1, (0, 0), 0.20, 20),
    ("judged", "mall-vlp16", "mall", "vlp-16", 22, 80, 0.1, (0, 0), 0.20, 20),
    ("judged", "campus-avia-b", "campus", "avia", 23, 80, 0.1, (0.02, 0.0017), 0.25, 50),
    ("judged", "campus-vlp16", "campus", "vlp-16", 24, 80, 0.1, (0, 0), 0.25, 50),
    ("judged", "street-aeva", "street", "aeva", 25, 60, 0.1, (0, 0), 0.25, 50),
    ("judged", "street-os2", "street", "os2-128", 26, 50, 0.1, (0, 0), 0.25, 50),
    ("judged", "street-os1-noisy", "street", "os1-64", 27, 60, 0.1, (0.05, 0.0017), 0.25, 50),
    ("judged", "street-vlp16-5hz", "street", "vlp-16", 28, 60, 0.2, (0, 0), 0.25, 50),
    ("judged", "street-hdl64-20hz", "street", "hdl-64e", 29, 80, 0.05, (0, 0), 0.25, 50),
    ("judged", "highway-hdl64", "highway", "hdl-64e", 30, 60, 0.1, (0.02, 0.0017), 0.25, 50),
    ("judged", "parked-os1", "parked", "os1-64", 31, 60, 0.1, (0.03, 0.0026), 0.25, 50),
    ("judged", "parked-os1-j1", "parked", "os1-64", 51, 50, 0.1, (0.03, 0.0026), 0.25, 50),
    ("judged", "parked-os1-j2", "parked", "os1-64", 52, 50, 0.1, (0.03, 0.0026), 0.25, 50),
    ("judged", "parked-hdl-j3", "parked", "hdl-64e", 53, 50, 0.1, (0.03, 0.0026), 0.25, 50),
]


def park_cars(scene, seed):
    """Fills both kerbs of the street with parked cars and vans, passed closely and faster, with noisier
    ranges and on a slope; five road users stay."""
    draw = random.Random(seed)
    users = [m for m in scene["movers"] if m["route"]["legs"] and m["kind"] in ("cyclist", "car")][:5]
    parked = []
    for side_m in (-5.2, 1.9):
        x_m = 4.0
        while x_m < 215:
            if draw.random() < 0.75:
                kind = "car" if draw.random() < 0.85 else "truck"
                route = {"from_m": [x_m, side_m + draw.uniform(-0.3, 0.3)], "legs": [], "after": "stay",
                         "start_s": 0.0}
                parked.append({"kind": kind, "route": route, "labelled": True})
            x_m += draw.uniform(5.5, 9)
    scene["movers"] = users + parked
    scene["range_noise_m"] = 0.03
    scene["ego"]["route"]["legs"][0]["speed_m_s"] = 12.0
    scene["ground"] = [{"height_m": 0.0, "slope_x": 0.015, "slope_y": 0.02}]


def add_pose_noise(source, target, noise, seed):
    """Shifts every pose and turns it by a small random rotation (first order, made orthonormal)."""
    draw = random.Random(seed)
    shift_m, turn_rad = noise
    lines = []
    for line in source.read_text().splitlines():
        pose = [float(number) for number in line.split()]
        rows = [pose[0:3], pose[4:7], pose[8:11]]
        a, b, c = (draw.gauss(0, turn_rad) for _ in range(3))
        first = [r[0] + c * r[1] - b * r[2] for r in rows]
        second = [r[1] - c * r[0] + a * r[2] for r in rows]
        scale = sum(v * v for v in first) ** 0.5
        first = [v / scale for v in first]
        along = sum(p * q for p, q in zip(first, second))
        second = [q - along * p for p, q in zip(first, second)]
        scale = sum(v * v for v in second) ** 0.5
        second = [v / scale for v in second]
        third = [first[1] * second[2] - first[2] * second[1], first[2] * second[0] - first[0] * second[2],
                 first[0] * second[1] - first[1] * second[0]]
        shift = [draw.gauss(0, shift_m) for _ in range(3)]
        lines.append(" ".join(repr(v) for i in range(3)
                              for v in (first[i], second[i], third[i], pose[4 * i + 3] + shift[i])))
    target.write_text("\n".join(lines) + "\n")


def simulated(program, work, row):
    """The folder of a simulated sequence, made when it is not there yet."""
    _, name, scene_name, sensor, seed, scans, period_s, noise, _, _ = row
    folder = work / name
    sequence = folder / "sequences" / "08"
    if not folder.exists():
        begun = work / f"{name}.begun"
        shutil.rmtree(begun, ignore_errors=True)
        command = [program, "simulate", "--layout", "semantickitti", "--seed", str(seed), "--out", begun]
        known = "street" if scene_name == "parked" else scene_name
        subprocess.run([*command, "--scene", known, "--scans", "1"], check=True, capture_output=True)
        scene = json.loads((begun / "scene.json").read_text())
        shutil.rmtree(begun)
        scene |= {"sensor": sensor, "scan_period_s": period_s}
        if scene_name == "parked":
            park_cars(scene, seed)
        file = work / f"{name}.json"
        file.write_text(json.dumps(scene))
        subprocess.run([*command, "--scene", file, "--scans", str(scans)], check=True, capture_output=True)
        inside = begun / "sequences" / "08"
        add_pose_noise(inside / "poses.txt", inside / "noisy_poses.txt", noise, seed)
        begun.rename(folder)
    return sequence


def run(program, work, sequence, arguments, settings):
    """The counts of all scans."""
    out = work / "run"
    poses = sequence / "noisy_poses.txt"
    options = ["--poses", poses] if poses.exists() else []
    sets = [part for key, value in settings.items() for part in ("--set", f"{key}={value}")]
    subprocess.run([program, "run", sequence, "--dataset", "semantickitti", "--threads", "1", "--overwrite",
                    "--out", out, *arguments, *sets, *options], check=True, capture_output=True)
    result = json.loads(next(out.glob("*/result.json")).read_text())
    shutil.rmtree(out)
    return result["scans"]


def metrics(scans):
    tp, fp, fn = (sum(scan[key] for scan in scans) for key in ("tp", "fp", "fn"))
    return [100 * tp / max(1, whole) for whole in (tp + fp + fn, tp + fp, tp + fn)]


def row_of(program, work, name, sequence, settings, skip=0):
    """Prints a row and returns the IoU of each method."""
    ious, cells = [], []
    for arguments in METHODS.values():
        scans = run(program, work, sequence, arguments, settings)
        iou, precision, recall = metrics(scans[skip:])
        ious.append(iou)
        cells.append(f"{iou:.1f} ({precision:.1f}, {recall:.1f})")
    print(f"| {name} | {' | '.join(cells)} | {ious[-1] - ious[0]:+.1f} |", flush=True)
    return ious


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(ROOT / "build/release/eval/mosbench"))
    parser.add_argument("--work", type=pathlib.Path, required=True, help="folder for simulated sequences")
    parser.add_argument("--kitti", type=pathlib.Path, help="sequence folder of a real recording")
    parser.add_argument("--delay", type=int, default=0, help="scans (default: 0, online)")
    chosen = parser.parse_args()
    chosen.work.mkdir(parents=True, exist_ok=True)
    header = f"| sequence | {' | '.join(METHODS)} | plus - paper |\n|---|{'---|' * len(METHODS)}---|"
    for group in ("tuned", "judged"):
        print(f"\nSimulated, {group}:\n\n{header}")
        ious = []
        for row in (row for row in SEQUENCES if row[0] == group):
            settings = {"voxel_size_m": row[8], "min_range_m": 0.5 if row[8] == 0.2 else 1.5,
                        "max_range_m": row[9], "delay_scans": chosen.delay}
            sequence = simulated(chosen.program, chosen.work, row)
            ious.append(row_of(chosen.program, chosen.work, row[1], sequence, settings))
        means = [f"{statistics.fmean(column):.1f}" for column in zip(*ious)]
        gains = [row[-1] - row[0] for row in ious]
        print(f"| mean | {' | '.join(means)} | {statistics.fmean(gains):+.1f}, least {min(gains):+.1f} |")
    if chosen.kitti:
        print(f"\nReal, judged, without the first {SKIPPED_REAL_SCANS} scans:\n\n{header}")
        settings = {"voxel_size_m": 0.25, "min_range_m": 1.5, "max_range_m": 50, "delay_scans": chosen.delay}
        row_of(chosen.program, chosen.work, chosen.kitti.name, chosen.kitti, settings, SKIPPED_REAL_SCANS)


if __name__ == "__main__":
    main()
