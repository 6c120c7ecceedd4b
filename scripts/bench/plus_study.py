#!/usr/bin/env python3
"""Compares hmm-mos-plus with the paper's method on simulated sequences and on a real one.

    scripts/bench/plus_study.py --work FOLDER [--kitti SEQUENCE] > docs/history/plus/table.md

Simulates every sequence below into FOLDER (once), runs the methods on all of them, online and delayed by
3 and 10 scans, profiles them, and prints a table of each; --parts 0,cost prints two of them alone. The defaults of hmm-mos-plus were chosen on the group "tuned"; those of "judged"
have other seeds and most other sensors, "rough" ones what real streets have and the others lack. --kitti names a sequence in the layout of SemanticKITTI that
is judged, too; its numbers are real and stand apart.
"""

import argparse
import json
import pathlib
import random
import shutil
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
ARRIVALS = ["--set", "min_seed_share=0.2,object_age_s=3,min_fresh_share=0,max_aged_share=1,"
            "min_rise_voxels=0,max_unknown_voxels=15,max_growth_m=1000,min_track_steps=0,"
            "max_gap_voxels=0,min_pure_seeds_voxels=3,seed_age_s=1,max_pure_extent_m=10"]
METHODS = {"paper": ["--method", "hmm-mos"], "arrivals": ["--method", "hmm-mos-plus", *ARRIVALS],
           "plus": ["--method", "hmm-mos-plus"]}
SKIPPED_REAL_SCANS = 4  # those that the paper's method does not judge
MADE_OF = "made_of.json"  # in the folder of a sequence: its seed, scans, noise and scene
WARM_UP_SCANS, PROFILED_SCANS, ROUNDS = 10, 30, 3
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
    ("tuned", "lane-hdl-t1", "lane", "hdl-64e", 303, 70, 0.1, (0.01, 0.0006), 0.25, 50),
    ("tuned", "lane-hdl-t2", "lane", "hdl-64e", 304, 70, 0.1, (0.01, 0.0006), 0.25, 50),
    ("tuned", "lane-hdl-t3", "lane", "hdl-64e", 306, 70, 0.1, (0.01, 0.0006), 0.25, 50),
    ("tuned", "lane-hdl-t4", "lane", "hdl-64e", 309, 70, 0.1, (0.01, 0.0006), 0.25, 50),
    *(("tuned", f"lane-hdl-{seed}", "lane", "hdl-64e", seed, 70, 0.1, (0.01, 0.0006), 0.25, 50)
      for seed in range(330, 342)),
    *(("tuned", f"lane-os1-{seed}", "lane", "os1-64", seed, 60, 0.1, (0.01, 0.0006), 0.25, 50)
      for seed in range(342, 346)),
    ("tuned", "lane-os2-t5", "lane", "os2-128", 321, 60, 0.1, (0.02, 0.0017), 0.25, 50),
    ("tuned", "lane-os2-t6", "lane", "os2-128", 322, 60, 0.1, (0.02, 0.0017), 0.25, 50),
    ("tuned", "lane-os1-t7", "lane", "os1-64", 323, 60, 0.1, (0.02, 0.0017), 0.25, 50),
    ("tuned", "lane-os2-t8", "lane", "os2-128", 325, 60, 0.1, (0.02, 0.0017), 0.25, 50),
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
    ("judged", "lane-hdl-j1", "lane", "hdl-64e", 310, 70, 0.1, (0.01, 0.0006), 0.25, 50),
    ("judged", "lane-os1", "lane", "os1-64", 312, 70, 0.1, (0.02, 0.0017), 0.25, 50),
    ("judged", "lane-vlp16", "lane", "vlp-16", 314, 70, 0.1, (0.01, 0.0006), 0.25, 50),
    ("judged", "lane-os2", "lane", "os2-128", 315, 60, 0.1, (0.02, 0.0017), 0.25, 50),
    ("judged", "lane-aeva", "lane", "aeva", 316, 70, 0.1, (0.01, 0.0006), 0.25, 50),
    ("judged", "lane-hdl-j2", "lane", "hdl-64e", 351, 70, 0.1, (0.01, 0.0006), 0.25, 50),
    ("judged", "lane-hdl-j3", "lane", "hdl-64e", 352, 70, 0.1, (0.01, 0.0006), 0.25, 50),
    ("judged", "lane-hdl-j4", "lane", "hdl-64e", 353, 70, 0.1, (0.01, 0.0006), 0.25, 50),
    ("judged", "lane-hdl-j5", "lane", "hdl-64e", 355, 70, 0.1, (0.01, 0.0006), 0.25, 50),
    ("judged", "lane-os1-j6", "lane", "os1-64", 361, 60, 0.1, (0.02, 0.0017), 0.25, 50),
    ("judged", "lane-os1-j7", "lane", "os1-64", 362, 60, 0.1, (0.01, 0.0006), 0.25, 50),
    ("judged", "lane-vlp16-j8", "lane", "vlp-16", 363, 60, 0.1, (0.01, 0.0006), 0.25, 50),
    ("judged", "lane-os2-j9", "lane", "os2-128", 365, 60, 0.1, (0.02, 0.0017), 0.25, 50),
    ("judged", "lane-aeva-j10", "lane", "aeva", 367, 60, 0.1, (0.01, 0.0006), 0.25, 50),
    ("judged", "street-hdl64-j11", "street", "hdl-64e", 368, 60, 0.1, (0.01, 0.0006), 0.25, 50),
    ("judged", "highway-vlp16-j12", "highway", "vlp-16", 369, 60, 0.1, (0.01, 0.0006), 0.25, 50),
    ("judged", "highway-os2-j13", "highway", "os2-128", 370, 60, 0.1, (0.01, 0.0006), 0.25, 50),
    ("rough", "rough-os1", "rough", "os1-64", 81, 60, 0.1, (0.02, 0.0017), 0.25, 50),
    ("rough", "rough-vlp16", "rough", "vlp-16", 82, 60, 0.1, (0.02, 0.0017), 0.25, 50),
    ("rough", "rough-hdl64", "rough", "hdl-64e", 83, 60, 0.1, (0.02, 0.0017), 0.25, 50),
    ("rough", "rough-avia", "rough", "avia", 84, 60, 0.1, (0.02, 0.0017), 0.25, 50),
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


def roughen(scene, seed):
    """Makes of a parked street what real ones have: kerbs and bumps, thin poles, leaves that sway, glass,
    mirrors, beams that fall on two things, people who go slowly, and a car that stops and goes."""
    walkers = [m for m in scene["movers"] if m["kind"] == "pedestrian"][::2]
    park_cars(scene, seed)
    draw = random.Random(seed + 1000)
    for walker in walkers:
        for leg in walker["route"]["legs"]:
            leg["speed_m_s"] *= draw.choice([0.4, 0.6, 1.0])
    scene["movers"] += walkers
    for leg in next(m for m in scene["movers"] if m["kind"] == "car")["route"]["legs"]:
        leg["wait_s"] = 2.0
    scene |= {"ground_bumps_m": 0.03, "beam_width_rad": 0.003}
    scene["ego"]["route"]["legs"][0]["speed_m_s"] = 8.0
    for structure in scene["structures"]:
        if structure["density"] < 1:
            structure["sway_m"] = draw.uniform(0.05, 0.2)

    def add(shape, x_m, y_m, size_m, **keys):
        foot_m = 0.015 * x_m + 0.02 * y_m
        scene["structures"].append({"shape": shape, "center_m": [x_m, y_m, foot_m + size_m[2] / 2],
                                    "size_m": size_m} | keys)
    for x_m in range(0, 216, 4):
        for y_m in (-8.0, 4.7):
            add("box", x_m, y_m, [4.0, 3.0, 0.12])
    for x_m in range(2, 216, 9):
        add("cylinder", x_m, -6.9, [0.06, 0.06, 3.0])
        add("cylinder", x_m + 4, 3.5, [0.1, 0.1, 5.0])
    for x_m in range(10, 216, 30):
        add("box", x_m, -9.4, [6.0, 0.02, 2.4], let_through=0.8)
        add("box", x_m + 12, -9.4, [6.0, 0.1, 2.4], let_through=0.5, mirrors=True)
        add("box", x_m + 5, 5.5, [7.0, 1.0, 1.4], density=0.4, sway_m=0.15)


def fill_lane(scene, seed):
    """A rough street without glass, where two cyclists ride ahead and a car or a truck comes towards them
    (even seeds) or drives ahead, too."""
    draw = random.Random(seed)
    cyclists = [m for m in scene["movers"] if m["route"]["legs"] and m["kind"] == "cyclist"][:2]
    roughen(scene, seed)
    scene["structures"] = [s for s in scene["structures"] if s.get("let_through", 0) == 0]
    parked = [m for m in scene["movers"] if not m["route"]["legs"]]
    draw.shuffle(parked)

    def drive(x_m, y_m, to_m, slowest_m_s, fastest_m_s):
        leg = {"to_m": [to_m, y_m], "speed_m_s": draw.uniform(slowest_m_s, fastest_m_s), "wait_s": 0}
        return {"from_m": [x_m, y_m], "legs": [leg], "after": "stay", "start_s": 0}
    for i, cyclist in enumerate(cyclists):
        x_m = 12 + 14 * i + draw.uniform(0, 8)
        cyclist["route"] = drive(x_m, -1.75 if draw.random() < 0.5 else -3.2, 220.0, 3, 6)
    if seed % 2:
        place = draw.uniform(30, 45), -1.75, 220.0
    else:
        place = draw.uniform(60, 110), 1.9, -20.0
        parked = [m for m in parked if m["route"]["from_m"][1] < 0]
    kind = draw.choice(["car", "truck"])
    vehicle = {"kind": kind, "route": drive(*place, 5, 9), "labelled": True}
    scene["movers"] = cyclists + [vehicle] + parked[:draw.randint(14, 30)]
    scene |= {"range_noise_m": 0.02, "ground_bumps_m": 0.02}
    scene["ego"]["route"]["legs"][0]["speed_m_s"] = draw.choice([6.0, 9.0, 12.0])


MADE_OF_STREET = {"parked": park_cars, "rough": roughen, "lane": fill_lane}


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


def scene_of(program, work, row):
    """The scene of a row: a built-in one with its sensor and its time per scan, or what is made of the street."""
    _, name, scene_name, sensor, seed, _, period_s, *_ = row
    known = "street" if scene_name in MADE_OF_STREET else scene_name
    seen = work / f"{name}.seen"
    shutil.rmtree(seen, ignore_errors=True)
    subprocess.run([program, "simulate", "--layout", "semantickitti", "--seed", str(seed), "--out", seen,
                    "--scene", known, "--scans", "1"], check=True, capture_output=True)
    scene = json.loads((seen / "scene.json").read_text())
    shutil.rmtree(seen)
    scene |= {"sensor": sensor, "scan_period_s": period_s}
    if scene_name in MADE_OF_STREET:
        MADE_OF_STREET[scene_name](scene, seed)
    return scene


def simulated(program, work, row):
    """The folder of a simulated sequence, made when it is not there yet. Ends the script where one of the same name
    was made of another row or scene: its numbers would be those of another sequence."""
    _, name, _, _, seed, scans, _, noise, _, _ = row
    folder = work / name
    scene = scene_of(program, work, row)
    made_of = json.dumps({"seed": seed, "scans": scans, "pose_noise": noise, "scene": scene})
    if folder.exists():
        kept = folder / MADE_OF
        if not kept.exists() or kept.read_text() != made_of:
            sys.exit(f"{folder}: was made of another row or scene than {name} is now, expected {MADE_OF} there to tell "
                     "the same; remove the folder or choose another --work")
        return folder / "sequences" / "08"
    begun = work / f"{name}.begun"
    shutil.rmtree(begun, ignore_errors=True)
    file = work / f"{name}.json"
    file.write_text(json.dumps(scene))
    subprocess.run([program, "simulate", "--layout", "semantickitti", "--seed", str(seed), "--out", begun,
                    "--scene", file, "--scans", str(scans)], check=True, capture_output=True)
    inside = begun / "sequences" / "08"
    add_pose_noise(inside / "poses.txt", inside / "noisy_poses.txt", noise, seed)
    (begun / MADE_OF).write_text(made_of)
    begun.rename(folder)
    return folder / "sequences" / "08"


def answers(program, work, sequence, arguments):
    """The leaderboard of the methods on a sequence, rows in their order, and their counts of all scans."""
    folders, scans = [work / "runs" / name for name in METHODS], []
    for folder, of_method in zip(folders, METHODS.values()):
        subprocess.run([program, "run", sequence, *of_method, *arguments, "--overwrite", "--out", folder],
                       check=True, capture_output=True)
        scans.append(json.loads(next(folder.glob("*/result.json")).read_text())["scans"])
    ranked = subprocess.run([program, "rank", *folders, "--order", "given", "--format", "json"],
                            check=True, stdout=subprocess.PIPE)
    shutil.rmtree(work / "runs")
    return json.loads(ranked.stdout)["rows"], scans


def metrics(scans):
    tp, fp, fn = (sum(scan[key] for scan in scans) for key in ("tp", "fp", "fn"))
    return [100 * tp / max(1, whole) for whole in (tp + fp + fn, tp + fp, tp + fn)]


def percent_text(estimate, form):
    """A number with its interval, where the scans are enough for one."""
    if estimate["low"] is None:
        return f"{100 * estimate['value']:{form}}"
    return f"{100 * estimate['value']:{form}} [{100 * estimate['low']:{form}}, {100 * estimate['high']:{form}}]"


def reading_of(sequence, row, delay_scans=0):
    """What the program is told of a sequence; `row` as in SEQUENCES."""
    poses = sequence / "noisy_poses.txt"
    sets = (f"voxel_size_m={row[8]},min_range_m={0.5 if row[8] == 0.2 else 1.5},max_range_m={row[9]},"
            f"delay_scans={delay_scans}")
    return ["--dataset", "semantickitti", "--set", sets, *(["--poses", poses] if poses.exists() else [])]


def print_row(chosen, name, sequence, reading):
    """Runs the methods, prints their row and returns the IoU of each and the counts of all scans."""
    rows, scans = answers(chosen.program, chosen.work, sequence, [*reading, "--threads", "1"])
    cells = []
    for row in rows:
        precision, recall = (100 * row["all"][key]["value"] for key in ("precision", "recall"))
        cells.append(f"{percent_text(row['all']['iou'], '.1f')} ({precision:.1f}, {recall:.1f})")
    cells.append(percent_text(rows[-1]["to_first"], "+.1f"))
    print(f"| {name} | {' | '.join(cells)} |", flush=True)
    return [100 * row["all"]["iou"]["value"] for row in rows], scans


def mean_row(means, gains):
    """With the interval of the mean gain over sequences like these: they are drawn anew 10,000 times."""
    draw = random.Random(1)
    drawn = sorted(statistics.fmean(draw.choices(gains, k=len(gains))) for _ in range(10000))
    return (f"| mean | {' | '.join(means)} | {statistics.fmean(gains):+.1f} [{drawn[249]:+.1f}, {drawn[9749]:+.1f}], "
            f"least {min(gains):+.1f} |")


def print_group(chosen, rows, delay_scans):
    ious = []
    for row in rows:
        sequence = simulated(chosen.program, chosen.work, row)
        ious.append(print_row(chosen, row[1], sequence, reading_of(sequence, row, delay_scans))[0])
    means = [f"{statistics.fmean(column):.1f}" for column in zip(*ious)]
    gains = [row[-1] - row[0] for row in ious]
    print(mean_row(means, gains))


def print_real(chosen, row, delay_scans):
    _, scans = print_row(chosen, row[1], chosen.kitti, reading_of(chosen.kitti, row, delay_scans))
    later = [metrics(of_method[SKIPPED_REAL_SCANS:]) for of_method in scans]
    cells = [f"{iou:.1f} ({precision:.1f}, {recall:.1f})" for iou, precision, recall in later]
    print(f"| from scan {SKIPPED_REAL_SCANS} on | {' | '.join(cells)} | {later[-1][0] - later[0][0]:+.1f} |")


def print_delay(chosen, groups, delay_scans):
    header = f"| sequence | {' | '.join(METHODS)} | plus - paper |\n|---|{'---|' * len(METHODS)}---|"
    print(f"\n## {f'Delayed by {delay_scans} scans' if delay_scans else 'Online'}")
    for title, rows in groups.items():
        print(f"\n{title}:\n\n{header}")
        if title.startswith("Real"):
            print_real(chosen, rows[0], delay_scans)
        else:
            print_group(chosen, rows, delay_scans)


def profiled(chosen, sequence, reading, of_method, threads):
    """CPU milliseconds per scan once the start is over, and the most bytes that the method held."""
    file = chosen.work / "profile.json"
    subprocess.run([chosen.program, "profile", sequence, *of_method, *reading, "--threads", str(threads),
                    "--scans", str(PROFILED_SCANS), "--json", file], check=True, capture_output=True)
    scans = json.loads(file.read_text())["sequences"][0]["scans"][WARM_UP_SCANS:]
    return (statistics.fmean(scan["method_cpu_ms"] for scan in scans),
            max(scan["method_bytes"] for scan in scans))


def print_cost(chosen, groups):
    """Methods are measured in turns; the lowest of the rounds counts."""
    names = list(METHODS)
    print(f"\n## Cost, online\n\nMilliseconds of CPU per scan, one thread; then the ratios of plus to paper.\n\n"
          f"| sequence | {' | '.join(names)} | 1 thread | 2 threads | memory |\n|---|{'---|' * len(names)}---|---|---|")
    ratios = []
    for row in (row for rows in groups.values() for row in rows):
        sequence = chosen.kitti if row[0] == "real" else simulated(chosen.program, chosen.work, row)
        cases = [(name, threads) for threads in (1, 2) for name in names]
        rounds = [{case: profiled(chosen, sequence, reading_of(sequence, row), METHODS[case[0]], case[1])
                   for case in cases} for _ in range(ROUNDS)]
        ms = {case: min(found[case][0] for found in rounds) for case in cases}
        held = {case: max(found[case][1] for found in rounds) for case in cases}
        ratios.append([ms["plus", 1] / ms["paper", 1], ms["plus", 2] / ms["paper", 2],
                       held["plus", 1] / held["paper", 1]])
        print(f"| {row[1]} | {' | '.join(f'{ms[name, 1]:.1f}' for name in names)} | "
              f"{' | '.join(f'{ratio:.2f}' for ratio in ratios[-1])} |", flush=True)
    columns = [f"{statistics.fmean(column):.2f}, most {max(column):.2f}" for column in zip(*ratios)]
    print(f"| mean | {' | ' * (len(names) - 1)} | {' | '.join(columns)} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(ROOT / "build/release/eval/mosbench"))
    parser.add_argument("--work", type=pathlib.Path, required=True, help="folder for simulated sequences")
    parser.add_argument("--kitti", type=pathlib.Path, help="sequence folder of a real recording")
    parser.add_argument("--parts", default="0,3,10,cost", help="delays in scans, and cost")
    chosen = parser.parse_args()
    chosen.work.mkdir(parents=True, exist_ok=True)
    groups = {}
    if chosen.kitti:
        groups["Real, judged"] = [("real", chosen.kitti.name, "", "", 0, 0, 0.1, (0, 0), 0.25, 50)]
    for group in ("judged", "rough", "tuned"):
        groups[f"Simulated, {group}"] = [row for row in SEQUENCES if row[0] == group]
    parts = chosen.parts.split(",")
    if parts[0] == "0":
        print("# hmm-mos-plus on all sequences\n\nWritten by `scripts/bench/plus_study.py`; README.md says what the "
              "columns are. IoU in % (precision, recall),\nthen the difference of IoU in points, each with its 95 % "
              "interval where a sequence has the 100 scans that one needs; the\nmean difference with that over "
              "sequences drawn anew.")
    for part in parts:
        if part == "cost":
            print_cost(chosen, groups)
        else:
            print_delay(chosen, groups, int(part))


if __name__ == "__main__":
    main()
