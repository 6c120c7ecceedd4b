#!/usr/bin/env python3
"""Measures what poses found by odometry mean for segmentation.

    scripts/bench/odometry_study.py --work FOLDER [--kitti SEQUENCE] [--methods A,B] [--sequences A,B]

Simulates every sequence below into FOLDER, finds poses, runs every method with the true poses, with
those found, and with the true ones disturbed, and prints tables of moving IoU beside the errors of the
poses. --kitti names a sequence in the layout of SemanticKITTI that is added; its rows are not marked as
simulated. The same command again keeps what an earlier call finished.
"""

import argparse
import json
import pathlib
import random
import resource
import shutil
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
# name, scene, sensor, seed, scans, preset: every scene, every sensor
SEQUENCES = [
    ("mall-os1", "mall", "os1-64", 61, 60, "doals-20m"),
    ("campus-avia", "campus", "avia", 63, 60, "semantickitti"),
    ("street-vlp16", "street", "vlp-16", 65, 60, "semantickitti"),
    ("street-aeva", "street", "aeva", 66, 50, "semantickitti"),
    ("street-os2", "street", "os2-128", 67, 40, "semantickitti"),
    ("highway-hdl64", "highway", "hdl-64e", 69, 50, "semantickitti"),
]
# The sensor's carrier is nearer than this.
RANGE = ["--set", "min_range_m=1.5"]
FOUND = {
    "SiMpLE": ["--odometry", "simple", *RANGE],
    "SiMpLE, --drop-moving": ["--odometry", "simple", "--drop-moving", *RANGE],
    "KISS-ICP": ["--odometry", "kiss", *RANGE],
}
# Independent errors of every pose: metres along each axis, degrees about each axis.
DISTURBED = {"2 cm, 0.1 deg": (0.02, 0.1), "10 cm, 0.5 deg": (0.1, 0.5)}
METHODS = ["hmm-mos", "hmm-mos-plus", "dynablox", "lc-free-space", "underwood", "yoon", "octomap", "dufomap"]


class Study:
    """Runs the program and keeps what it finds below a folder."""

    def __init__(self, program, work):
        self.program, self.work = program, work

    def call(self, *arguments):
        """Returns stdout. Exit code 1 says that poses are doubtful."""
        done = subprocess.run([self.program, *map(str, arguments)], capture_output=True, text=True)
        if done.returncode > 1:
            raise SystemExit(f"mosbench {' '.join(map(str, arguments))}: {done.stderr}")
        return done.stdout

    def simulated(self, name, scene_name, sensor, seed, scans):
        """The folder of a simulated sequence, made when it is not there yet."""
        folder = self.work / "sequences" / name
        if not folder.exists():
            begun = self.work / "begun"
            shutil.rmtree(begun, ignore_errors=True)
            command = ["simulate", "--layout", "semantickitti", "--seed", seed, "--out", begun, "--scene"]
            self.call(*command, scene_name, "--scans", 1)
            scene = json.loads((begun / "scene.json").read_text())
            shutil.rmtree(begun)
            file = self.work / f"{name}.json"
            file.write_text(json.dumps(scene | {"sensor": sensor}))
            self.call(*command, file, "--scans", scans)
            folder.parent.mkdir(parents=True, exist_ok=True)
            (begun / "sequences" / "08").rename(folder)
        return folder

    def lidar_poses(self, name, sequence):
        """A file of the true poses of the LiDAR, which calib.txt makes of the camera's."""
        file = self.work / "poses" / f"{name}.true.txt"
        if not file.exists():
            file.parent.mkdir(parents=True, exist_ok=True)
            converted = self.work / "converted"
            shutil.rmtree(converted, ignore_errors=True)
            self.call("convert", sequence, "--dataset", "semantickitti", "--layout", "sipailou", "--out", converted)
            shutil.move(next(converted.rglob("poses.txt")), file)
            shutil.rmtree(converted)
        return file

    def found_poses(self, name, sequence, title):
        """A file of poses, and what is known of them."""
        stem = self.work / "poses" / f"{name}.{title.replace(', ', '')}"
        file, record = stem.with_name(stem.name + ".txt"), stem.with_name(stem.name + ".json")
        if not record.exists():
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            answer = json.loads(self.call("odometry", sequence, "--dataset", "semantickitti", "--threads", 1,
                                          "-o", file, "--json", *FOUND[title]))["sequences"][0]
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            cpu_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
            record.write_text(json.dumps({"doubtful": answer["doubtful"],
                                          "cpu_ms": 1000 * cpu_s / len(answer["scans"])}))
        return file, json.loads(record.read_text())

    def disturbed_poses(self, name, truth, title):
        file = self.work / "poses" / f"{name}.{title.replace(' ', '')}.txt"
        if not file.exists():
            disturb(truth, file, *DISTURBED[title])
        return file, {}

    def errors(self, estimate, truth):
        scored = json.loads(self.call("trajectory", estimate, "--truth", truth, "--align", "origin", "--json"))
        one = scored["sequences"][0]
        return {"ape_m": one["absolute"]["translation_m"]["rmse"], "rpe_m": one["relative"]["translation_m"]["rmse"],
                "rpe_deg": 57.29577951308232 * one["relative"]["rotation_rad"]["rmse"]}

    def moving_iou(self, name, sequence, poses, title, method, preset):
        """In per cent, over all labelled scans."""
        out = self.work / "runs" / name / title.replace(" ", "").replace(",", "-") / method
        self.call("run", sequence, "--dataset", "semantickitti", "--method", method, "--preset", preset,
                  "--protocol", "semantickitti-mos", "--poses", poses, "--pose-frame", "lidar", "--threads", 1,
                  "--out", out)
        iou = json.loads(next(out.rglob("result.json")).read_text())["summary"]["iou"]
        return float("nan") if iou is None else 100 * iou


def disturb(source, target, shift_m, turn_deg):
    """Shifts and turns every pose at random, the same way in every call."""
    draw = random.Random(f"{source.name} {shift_m}")
    rows = []
    for line in source.read_text().splitlines():
        row = [float(number) for number in line.split()]
        turn = rotation(*(draw.gauss(0, turn_deg) / 57.29577951308232 for _ in range(3)))
        for i in range(3):
            old = row[4 * i:4 * i + 3]
            row[4 * i:4 * i + 3] = [sum(old[k] * turn[k][j] for k in range(3)) for j in range(3)]
            row[4 * i + 3] += draw.gauss(0, shift_m)
        rows.append(" ".join(map(repr, row)))
    target.write_text("\n".join(rows) + "\n")


def rotation(x_rad, y_rad, z_rad):
    """The rotation of a unit quaternion whose vector part is half of these small angles."""
    x, y, z = x_rad / 2, y_rad / 2, z_rad / 2
    w = (1 - x * x - y * y - z * z) ** 0.5
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]


def poses_of(study, name, sequence):
    """By title: file, errors, and what odometry says of them."""
    truth = study.lidar_poses(name, sequence)
    poses = {"true": (truth, {"ape_m": 0.0, "rpe_m": 0.0, "rpe_deg": 0.0})}
    for title in [*FOUND, *DISTURBED]:
        file, known = study.found_poses(name, sequence, title) if title in FOUND else study.disturbed_poses(
            name, truth, title)
        poses[title] = file, known | study.errors(file, truth)
    return poses


def cell(value, digits):
    return "-" if value is None else f"{value:.{digits}f}"


def print_table(head, rows):
    print("| " + " | ".join(head) + " |\n|" + "---|" * len(head))
    for row in rows:
        print("| " + " | ".join(row) + " |")
    print(flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(ROOT / "build/release/eval/mosbench"))
    parser.add_argument("--work", type=pathlib.Path, required=True, help="folder for sequences, poses and runs")
    parser.add_argument("--kitti", type=pathlib.Path, help="sequence folder of a real recording")
    parser.add_argument("--methods", default=",".join(METHODS), help="names, a,b (default: all)")
    parser.add_argument("--sequences", help="of those below, a,b or none (default: all)")
    chosen = parser.parse_args()
    study = Study(chosen.program, chosen.work)
    chosen.work.mkdir(parents=True, exist_ok=True)
    methods = chosen.methods.split(",")
    sequences = [(chosen.kitti.name, chosen.kitti, "semantickitti")] if chosen.kitti else []
    wanted = chosen.sequences.split(",") if chosen.sequences else [row[0] for row in SEQUENCES]
    sequences += [(name, study.simulated(name, *made), preset) for name, *made, preset in SEQUENCES
                  if name in wanted]
    changes, rows = {}, []
    for name, sequence, preset in sequences:
        simulated = "" if chosen.kitti and name == chosen.kitti.name else " (simulated)"
        true_iou = {}
        for title, (file, known) in poses_of(study, name, sequence).items():
            row = [name + simulated, title, cell(known["ape_m"], 3), cell(known["rpe_m"], 4),
                   cell(known["rpe_deg"], 3), str(known.get("doubtful", "-")), cell(known.get("cpu_ms"), 0)]
            for method in methods:
                # The filter of --drop-moving is hmm-mos.
                if method != methods[0] and "drop" in title:
                    row.append("-")
                    continue
                iou = study.moving_iou(name, sequence, file, title, method, preset)
                change = iou - true_iou.setdefault(method, iou)
                changes.setdefault((title, method), []).append(change)
                row.append(f"{iou:.1f}" if title == "true" else f"{iou:.1f} ({change:+.1f})")
            rows.append(row)
            print(*row, sep="  ", file=sys.stderr, flush=True)
    print_table(["sequence", "poses", "APE m", "RPE m", "RPE deg", "doubtful", "CPU ms",
                 *methods], rows)
    print("Mean change of IoU against the true poses, and the worst:\n")
    print_table(["poses", *methods], [
        [title, *(f"{statistics.fmean(values):+.1f}, {min(values):+.1f}" if values else "-"
                  for values in (changes.get((title, method)) for method in methods))]
        for title in [*FOUND, *DISTURBED]])


if __name__ == "__main__":
    main()
