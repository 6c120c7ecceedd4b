#!/usr/bin/env python3
"""Plants faults into sound sequences and counts what `mosbench doctor` makes of each.

    scripts/check/doctor_plants.py                 # the scenes on which thresholds were chosen
    scripts/check/doctor_plants.py --scenes judged # other worlds, seeds and sensors
    scripts/check/doctor_plants.py --scenes sound  # 40 sequences in which nothing may be found
    scripts/check/doctor_plants.py --fault jump_3m --fault noise_10cm
    scripts/check/doctor_plants.py --record plants.jsonl   # also for scripts/check/doctor_margins.py

Takes minutes. Prints per scene and fault: named, found (something else that is no advice), WRONG (advice that does
not fit), noted (in a remark, where the fault may be sound), missed, or silent where the fault changes no motion by
5 cm or 0.3 degrees; with the measures that the doctor compares with its thresholds: deviation of the poses ("unsound";
1 is noise of 5 cm) and of measured motions among themselves, best gain in likelihood of another convention, and how
pure and how moving the moving labels are. Sound sequences show how near to the thresholds these come; what is found in
them is a false ALARM. Exit code 1 when an advice was wrong or an alarm false.
"""

import argparse
import concurrent.futures
import itertools
import json
import math
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
KITTI = ROOT.parent / "shared/parity/kitti_0005.tar.xz"
KITTI_SCANS = 50
# Layout, scene, scans, seed, folder of the sequence that is examined.
SCENES = {
    "chosen": [
        ("semantickitti", "street", 50, 11, "sequences/08"),
        ("doals", "mall", 60, 11, "mall/sequence_1"),
        ("sipailou", "campus", 60, 11, "sequences/06"),
        ("helimos", "street", 40, 13, "KAIST05/Deskewed_LiDAR/Ouster"),
        ("semantickitti", "highway", 50, 11, "sequences/08"),
        ("helimos", "highway", 50, 21, "KAIST05/Deskewed_LiDAR/Aeva"),
    ],
    "judged": [
        ("semantickitti", "campus", 50, 31, "sequences/08"),
        ("doals", "street", 50, 32, "street/sequence_1"),
        ("sipailou", "street", 50, 33, "sequences/06"),
        ("helimos", "campus", 50, 34, "KAIST05/Deskewed_LiDAR/Velodyne"),
        ("helimos", "highway", 50, 35, "KAIST05/Deskewed_LiDAR/Aeva"),
        ("kitti", "kitti_0005", KITTI_SCANS, 0, "."),
    ],
    "sound": [
        ("semantickitti", "street", 40, 41, "sequences/08"),
        ("semantickitti", "highway", 40, 42, "sequences/08"),
        ("semantickitti", "campus", 40, 43, "sequences/08"),
        ("semantickitti", "mall", 12, 44, "sequences/08"),
        ("doals", "mall", 40, 45, "mall/sequence_1"),
        ("doals", "campus", 40, 46, "campus/sequence_1"),
        ("doals", "street", 20, 47, "street/sequence_1"),
        ("sipailou", "campus", 60, 48, "sequences/06"),
        ("sipailou", "street", 40, 49, "sequences/06"),
        ("sipailou", "room", 30, 50, "sequences/06"),
    ],
}
SCENES["sound"] += [
    ("helimos", world, 40, 51 + number, f"KAIST05/Deskewed_LiDAR/{sensor}")
    for number, (world, sensor) in enumerate(itertools.product(("street", "highway", "campus"), ("Aeva", "Avia", "Ouster", "Velodyne")))
][:10]


# --- Poses: matrices (4, 4).


def motion(x=0.0, y=0.0, z=0.0, yaw=0.0, pitch=0.0):
    c, s, d, t = math.cos(yaw), math.sin(yaw), math.cos(pitch), math.sin(pitch)
    return np.array([[c * d, -s, c * t, x], [s * d, c, s * t, y], [-t, 0.0, d, z], [0.0, 0.0, 0.0, 1.0]])


def posed(pose, rotation=None, position=None):
    """The pose with another rotation or position."""
    pose = pose.copy()
    if rotation is not None:
        pose[:3, :3] = rotation
    if position is not None:
        pose[:3, 3] = position
    return pose


def pose_of(numbers):
    return np.vstack([np.array([float(number) for number in numbers]).reshape(3, 4), [0.0, 0.0, 0.0, 1.0]])


IDENTITY = np.eye(4)


class Copy:
    """A sequence folder whose scans are links until they are changed."""

    def __init__(self, sound, folder):
        self.folder = folder
        folder.mkdir(parents=True)
        for path in sorted(sound.iterdir()):
            if path.is_dir():
                (folder / path.name).symlink_to(path)
            else:
                shutil.copy(path, folder / path.name)
        self.random = random.Random(7)

    def own(self, name):
        path = self.folder / name
        if path.is_symlink():
            source = path.resolve()
            path.unlink()
            shutil.copytree(source, path)
        return sorted(path.iterdir())

    def tr(self):
        path = self.folder / "calib.txt"
        lines = path.read_text().splitlines() if path.exists() else []
        return next((pose_of(line.split(":")[1].split()) for line in lines if line.startswith("Tr")), IDENTITY)

    def stored_poses(self):
        return [pose_of(row.split()) for row in (self.folder / "poses.txt").read_text().splitlines()]

    def change_stored(self, change):
        lines = (" ".join(repr(float(value)) for value in pose[:3].ravel()) for pose in change(self.stored_poses()))
        (self.folder / "poses.txt").write_text("\n".join(lines) + "\n")

    def change_poses(self, change):
        """Changes the poses of the lidar."""
        tr, back = self.tr(), np.linalg.inv(self.tr())
        self.change_stored(lambda poses: [tr @ pose @ back for pose in change([back @ pose @ tr for pose in poses])])

    def change_points(self, change):
        """`change` gets the four columns of a scan and returns others."""
        for path in self.own("velodyne"):
            columns = change(np.fromfile(path, np.float32).reshape(-1, 4).T)
            np.ascontiguousarray(np.stack(list(columns), axis=1), np.float32).tofile(path)

    def change_labels(self, change):
        paths = self.own("labels")
        for path, labels in zip(paths, change([np.fromfile(path, np.uint32) for path in paths])):
            np.asarray(labels, np.uint32).tofile(path)

    def change_times(self, change):
        (self.folder / "indices.csv").unlink(missing_ok=True)  # it names scans by their stamps
        path = self.folder / "times.txt"
        stamps = change([float(row) for row in path.read_text().split()])
        path.write_text("".join(f"{stamp:.9f}\n" for stamp in stamps))


# --- Faults. Each takes a Copy.


def every(change):
    return lambda copy: copy.change_poses(lambda poses: [change(pose) for pose in poses])


def stored(change):
    return lambda copy: copy.change_stored(lambda poses: [change(pose) for pose in poses])


def moved(change):
    """The numbers x, y, z of the lidar's positions changed."""
    return every(lambda pose: posed(pose, position=change(*pose[:3, 3])))


def mounted(**place):
    return every(lambda pose: pose @ motion(**place))


def points(change):
    return lambda copy: copy.change_points(change)


def shifted(rows):
    def change(poses):
        return [poses[0]] * rows + poses[:-rows] if rows > 0 else poses[-rows:] + [poses[-1]] * -rows

    return lambda copy: copy.change_stored(change)


def frozen(first, count):
    def change(poses):
        begin = int(first * len(poses))
        return [poses[begin] if begin <= k < begin + count else pose for k, pose in enumerate(poses)]

    return lambda copy: copy.change_stored(change)


def lose_scan(copy):
    """A scan in the middle is lost and the last row cut, so that the numbers agree."""
    rows = len(copy.stored_poses())
    (copy.folder / "indices.csv").unlink(missing_ok=True)
    for name in ("velodyne", "labels"):
        if not (copy.folder / name).exists():
            continue
        paths = copy.own(name)
        if len(paths) < rows:
            shutil.rmtree(copy.folder / name)
            continue
        for path, after in zip(paths[rows // 2 :], paths[rows // 2 + 1 :]):
            after.replace(path)
    copy.change_stored(lambda poses: poses[:-1])
    if (copy.folder / "times.txt").exists():
        copy.change_times(lambda stamps: stamps[:-1])


def jumped(length):
    """Moves the second half of the way on, in the direction of the sensor's x axis there."""

    def change(poses):
        half = len(poses) // 2
        ahead = length * poses[half][:3, 0]
        return poses[:half] + [posed(pose, position=pose[:3, 3] + ahead) for pose in poses[half:]]

    return lambda copy: copy.change_poses(change)


def noisy(metres, degrees=0.0):
    def plant(copy):
        draw = copy.random.gauss

        def change(pose):
            at = [value + draw(0.0, metres) for value in pose[:3, 3]]
            turn = motion(yaw=math.radians(draw(0.0, degrees)), pitch=math.radians(draw(0.0, degrees)))
            return posed(pose @ turn, position=at)

        copy.change_poses(lambda poses: [change(pose) for pose in poses])

    return plant


def scaled(factor):
    return stored(lambda pose: posed(pose, position=factor * pose[:3, 3]))


def quaternion(m):
    """x y z w of a rotation."""
    w = math.sqrt(max(0.0, 1.0 + m[0][0] + m[1][1] + m[2][2])) / 2.0
    x = math.copysign(math.sqrt(max(0.0, 1.0 + m[0][0] - m[1][1] - m[2][2])) / 2.0, m[2][1] - m[1][2])
    y = math.copysign(math.sqrt(max(0.0, 1.0 - m[0][0] + m[1][1] - m[2][2])) / 2.0, m[0][2] - m[2][0])
    z = math.copysign(math.sqrt(max(0.0, 1.0 - m[0][0] - m[1][1] + m[2][2])) / 2.0, m[1][0] - m[0][1])
    return x, y, z, w


def rotation_of(x, y, z, w):
    return [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]


def w_first(pose):
    x, y, z, w = quaternion(pose)
    return posed(pose, rotation_of(w, x, y, z))


def turned_less(pose):
    """Angles in radians, taken for degrees."""
    x, y, z, w = quaternion(pose)
    angle = 2.0 * math.acos(max(-1.0, min(1.0, w)))
    sine = math.sin(angle / 2.0) or 1.0
    half = math.radians(angle) / 2.0
    return posed(pose, rotation_of(*(math.sin(half) * part / sine for part in (x, y, z)), math.cos(half)))


def other_way(copy):
    """Poses of another way: as fast, but winding."""

    def change(poses):
        step = math.dist(poses[0][:3, 3], poses[-1][:3, 3]) / len(poses) + 0.05
        return [
            motion(30.0 * step * math.sin(k / 20), 30.0 * step * math.cos(k / 15), 0.0, k / 15 + 0.5 * math.sin(k / 6))
            for k in range(len(poses))
        ]

    copy.change_poses(change)


def points_in_map(copy):
    tr = copy.tr()
    poses = iter([np.linalg.inv(tr) @ pose @ tr for pose in copy.stored_poses()])
    start = np.linalg.inv(np.linalg.inv(tr) @ copy.stored_poses()[0] @ tr)

    def change(columns):
        into_map = start @ next(poses)
        return [*(into_map[:3, :3] @ columns[:3].astype(float) + into_map[:3, 3:]), columns[3]]

    copy.change_points(change)


def zeroed(share):
    def plant(copy):
        def change(columns):
            left = [copy.random.random() >= share for _ in columns[3]]
            return [*(np.where(left, column, 0.0) for column in columns[:3]), columns[3]]

        copy.change_points(change)

    return plant


def cut_scan(copy):
    """Half of a scan and of its labels."""
    for name, item_bytes in (("velodyne", 16), ("labels", 4)):
        if not (copy.folder / name).exists():
            continue
        stem = sorted((copy.folder / "velodyne").iterdir())[15].stem
        for path in copy.own(name):
            if path.stem == stem:
                path.write_bytes(path.read_bytes()[: path.stat().st_size // item_bytes // 2 * item_bytes])


def exchanged(poses):
    row = len(poses) // 3
    return poses[:row] + [poses[row + 1], poses[row]] + poses[row + 2 :]


def one_off(poses):
    row = 2 * len(poses) // 3
    return poses[:row] + [posed(poses[row], position=poses[row][:3, 3] + (1.4, 1.4, 0.0))] + poses[row + 1 :]


def labels_of(later):
    """Labels of the labelled scan that comes so many later."""

    def change(all_labels):
        others = all_labels[later % len(all_labels) :] + all_labels[: later % len(all_labels)]
        return [np.pad(other[: len(own)], (0, max(0, len(own) - len(other)))) for own, other in zip(all_labels, others)]

    return lambda copy: copy.change_labels(change)


def shuffle_labels(copy):
    copy.change_labels(lambda all_labels: [copy.random.sample(list(labels), len(labels)) for labels in all_labels])


def relabelled(change):
    """`change` gets labels, which of them are no 0, and which mean that a point moves."""

    def changed(labels):
        ids = labels & 0xFFFF
        return change(labels, ids > 0, (ids >= 251) & (ids <= 259))

    return lambda copy: copy.change_labels(lambda all_labels: [changed(labels) for labels in all_labels])


def change_indices(change):
    """Changes the rows [stamp, indices...] of DOALS's truth."""

    def plant(copy):
        path = copy.folder / "indices.csv"
        rows = [row.split(",") for row in path.read_text().splitlines()]
        path.write_text("".join(",".join(row) + "\n" for row in change(rows, copy.random)))

    return plant


def is_harmless(copy, before):
    """Whether a fault of poses leaves all motions over 1 and 8 scans as they are, up to 5 cm and 0.3 degrees."""
    after = copy.stored_poses()
    if len(after) != len(before) or np.array_equal(after, before):
        return False
    for stride in (1, 8):
        for k in range(len(before) - stride):
            apart = np.linalg.inv(before[k]) @ before[k + stride] - np.linalg.inv(after[k]) @ after[k + stride]
            if np.linalg.norm(apart[:3, 3]) > 0.05 or np.abs(apart[:3, :3]).max() > math.radians(0.3):
                return False
    return True


NEUTRAL = re.compile(r"do not fit the scans in any convention|cannot be told|far smaller")
# Name: how it is planted, what the doctor has to say.
FAULTS = {
    "identity": (stored(lambda pose: IDENTITY), "all poses are equal"),
    "frozen_10_rows": (frozen(0.4, 10), "poses are frozen"),
    "frozen_4_rows": (frozen(0.7, 4), "poses are frozen"),
    "yaw_5": (mounted(yaw=math.radians(5)), "mounted with .* yaw"),
    "yaw_90": (mounted(yaw=math.radians(90)), "mounted with .* yaw"),
    "yaw_180": (mounted(yaw=math.radians(180)), "mounted with .* yaw"),
    "pitch_5": (mounted(pitch=math.radians(5)), "mounted with .* pitch"),
    "lever_2m": (mounted(x=2.0), "lever arm"),
    "lever_xz": (mounted(x=2.0, z=1.0), "lever arm"),
    "scale_1.1": (scaled(1.1), "times as long"),
    "millimetres": (scaled(1000.0), "times as long|millimetres"),
    "feet": (scaled(3.281), "times as long|feet"),
    "lost_scan": (lose_scan, "lost"),
    "noise_10cm": (noisy(0.10), "scatter"),
    "noise_20cm": (noisy(0.20), "scatter"),
    "jump_3m": (jumped(3.0), "poses jump"),
    "jump_1m": (jumped(1.0), "poses jump"),
    "shift_1": (shifted(1), "as one row later"),
    "shift_-1": (shifted(-1), "as one row earlier"),
    "shift_2": (shifted(2), "as 2 rows later"),
    "shift_3": (shifted(3), "as 3 rows later"),
    "shift_-3": (shifted(-3), "as 3 rows earlier"),
    "shift_5": (shifted(5), "as 5 rows later"),
    "shift_10": (shifted(10), "as 10 rows later"),
    "inverse": (stored(np.linalg.inv), "inverse"),
    "transposed": (stored(lambda pose: posed(pose, pose[:3, :3].T)), "transposed"),
    "no_rotation": (stored(lambda pose: posed(pose, np.eye(3))), "same rotation"),
    "w_first": (every(w_first), "w as the first"),
    "translation_xy_swapped": (moved(lambda x, y, z: (y, x, z)), "x and y of their trans"),
    "translation_y_mirrored": (moved(lambda x, y, z: (x, -y, z)), "sign of y of their trans"),
    "translation_z_zero": (moved(lambda x, y, z: (x, y, 0.0)), "same z"),
    "other_way": (other_way, "do not fit"),
    "reversed": (lambda copy: copy.change_stored(lambda poses: poses[::-1]), "reverse"),
    "points_in_map": (points_in_map, "in the map's"),
    "points_xy_swapped": (points(lambda c: c[[1, 0, 2, 3]]), "x and y of the points"),
    "points_y_mirrored": (points(lambda c: [c[0], -c[1], c[2], c[3]]), "points mirrored"),
    "points_z_flipped": (points(lambda c: [c[0], c[1], -c[2], c[3]]), "upside down"),
    "zero_points": (zeroed(0.3), "returns"),
    "points_mm": (points(lambda c: [*(c[:3] * 1000.0), c[3]]), "metres"),
    "points_km": (points(lambda c: [*(c[:3] * 0.001), c[3]]), "metres"),
    "big_endian": (points(np.ndarray.byteswap), "little-endian"),
    "intensity_first": (points(lambda c: c[[3, 0, 1, 2]]), "do not fit|columns"),
    "camera_axes": (points(lambda c: [-c[1], -c[2], c[0], c[3]]), "camera's axes"),
    "cut_scan": (cut_scan, "far smaller"),
    "radians": (every(turned_less), "radians"),
    "rows_exchanged": (lambda copy: copy.change_stored(exchanged), "exchanged"),
    "row_off": (lambda copy: copy.change_poses(one_off), "does not fit between"),
    "rows_shuffled": (lambda copy: copy.change_stored(lambda poses: random.Random(5).sample(poses, len(poses))), "do not fit"),
    "stamps_ms": (lambda copy: copy.change_times(lambda t: [1e3 * s for s in t]), "seconds"),
    "stamps_gap": (
        lambda copy: copy.change_times(lambda t: [s + (5.0 if k >= len(t) // 2 else 0.0) for k, s in enumerate(t)]),
        "comes .* s after",
    ),
    "labels_next": (labels_of(1), "labels do not fit|moving"),
    "labels_far": (labels_of(7), "labels do not fit|moving"),
    "labels_shuffled": (shuffle_labels, "labels do not fit|moving"),
    "labels_swapped": (relabelled(lambda labels, labelled, moves: np.where(labelled, np.where(moves, 9, 251), labels)), "labels .*(swapped|exchanged)"),
    "labels_static": (relabelled(lambda labels, labelled, moves: np.where(labelled, 9, labels)), "no point .*moving"),
    "labels_moving": (relabelled(lambda labels, labelled, moves: np.full_like(labels, 251)), "labels"),
    "indices_next": (
        change_indices(lambda rows, _: [[row[0]] + after[1:] for row, after in zip(rows, rows[1:] + rows[:1])]),
        "labels do not fit|moving",
    ),
    "indices_shuffled": (
        change_indices(
            lambda rows, rng: [row[:1] + [str(i) for i in sorted(rng.sample(range(131072), len(row) - 1))] for row in rows]
        ),
        "labels do not fit|moving",
    ),
}
# Sound data, without and with noise that is still sound: nothing may be found.
SOUND = {"sound": (lambda copy: None, None), "sound, 2 cm of noise": (noisy(0.02, 0.1), None)}
NOTED = {"labels_static"}  # faults that may be sound: a note names them, no symptom
NEEDS = {"stamps": "times.txt", "labels": "labels", "indices": "indices.csv"}


def judged(answer, name, harmless):
    texts = [symptom["what"] for symptom in answer["symptoms"]]
    if name in SOUND:
        return "ALARM" if texts else "silent"
    expected = FAULTS[name][1]
    if any(re.search(expected, text) for text in texts):
        return "named" if all(re.search(expected, t) or NEUTRAL.search(t) for t in texts) else "named+"
    remarks = [remark for sequence in answer["sequences"] for remark in sequence["remarks"]]
    if not texts and name in NOTED and any(re.search(expected, remark) for remark in remarks):
        return "noted"
    if not texts:
        return "silent" if harmless else "missed"
    return "found" if all(NEUTRAL.search(text) for text in texts) else "WRONG"


class Run:
    def __init__(self, program, work):
        self.program, self.work = program, work

    def sound_folder(self, layout, scene, scans, seed, folder):
        if layout == "kitti":
            if not KITTI.exists():
                return None
            if not (self.work / scene).exists():
                subprocess.run(["tar", "-xJf", str(KITTI), "-C", str(self.work)], check=True)
            return self.work / scene
        out = self.work / f"{layout}-{scene}-{scans}-{seed}"
        arguments = ["--layout", layout, "--scene", scene, "--scans", str(scans), "--seed", str(seed), "--out", str(out)]
        subprocess.run([self.program, "simulate", *arguments], check=True, capture_output=True)
        return out / folder

    def answer(self, folder, layout):
        kind = "semantickitti" if layout == "kitti" else layout
        done = subprocess.run(
            [self.program, "doctor", str(folder), "--dataset", kind, "--json"], capture_output=True, text=True
        )
        if not done.stdout.startswith("{"):
            return {"symptoms": [{"what": "FAILED: " + done.stderr.strip()}], "sequences": []}
        return json.loads(done.stdout)

    def planted(self, layout, sound, plant, relative):
        """Returns the doctor's answer, and whether the fault changes no motion by much."""
        with tempfile.TemporaryDirectory(dir=self.work) as root:
            folder = pathlib.Path(root) / relative if relative != "." else pathlib.Path(root) / "own"
            copy = Copy(sound, folder)
            before = copy.stored_poses()
            plant(copy)
            return self.answer(folder, layout), is_harmless(copy, before)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(ROOT / "build/release/eval/mosbench"))
    parser.add_argument("--scenes", choices=["chosen", "judged", "sound"], default="chosen")
    parser.add_argument("--only", help="a word in the name of the scene")
    parser.add_argument("--fault", action="append", choices=sorted(FAULTS))
    parser.add_argument("--seeds-from", type=int, default=0, help="added to the seeds of the scenes")
    parser.add_argument("--work", type=pathlib.Path, help="folder that keeps the simulated scenes")
    parser.add_argument("--record", type=pathlib.Path, help="file to which a JSON object per case is appended")
    flags = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        work = flags.work or pathlib.Path(temporary)
        work.mkdir(parents=True, exist_ok=True)
        run = Run(flags.program, work)
        sys.exit(check(run, flags))


def record(flags, case, verdict, answer):
    """Appends what doctor_margins.py reads."""
    if not flags.record:
        return
    sequence = answer["sequences"][0] if answer["sequences"] else {}
    row = {"case": case, "verdict": verdict, "measures": sequence.get("measures", {}), "thresholds": answer.get("thresholds")}
    with flags.record.open("a") as file:
        file.write(json.dumps(row) + "\n")


def measures(answer):
    """The numbers that thresholds are compared with."""
    sequence = answer["sequences"][0] if answer["sequences"] else {}
    poses, truth = sequence.get("poses"), sequence.get("truth")
    text = f"unsound {poses['unsound']:6.3f} of {poses['disagreement']:6.3f}" if poses else "not measured"
    if poses and poses.get("conventions"):
        text += f" gain {max(row['gain'] for row in poses['conventions']):6.1f}"
    if truth:
        text += f" purity {truth['purity']:.3f} leaves {truth['moving_leaves']:.3f} {truth['static_leaves']:.4f}"
    return text


def check(run, flags):
    plants = SOUND if flags.scenes == "sound" else {name: FAULTS[name] for name in flags.fault or FAULTS}
    counts = {}
    for layout, scene, scans, seed, relative in SCENES[flags.scenes]:
        if flags.only and flags.only not in f"{layout}-{scene}-{relative}":
            continue
        sound = run.sound_folder(layout, scene, scans, seed + flags.seeds_from, relative)
        if sound is None:
            print(f"{scene}: skipped, {KITTI.name} is not there")
            continue
        count = counts.setdefault(f"{layout}-{scene}", {})

        def examine(name):
            answer, harmless = run.planted(layout, sound, plants[name][0], relative)
            return name, judged(answer, name, harmless), answer

        needed = {name: [file for word, file in NEEDS.items() if name.startswith(word)] for name in plants}
        possible = [name for name, files in needed.items() if all((sound / file).exists() for file in files)]
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            for name, verdict, answer in pool.map(examine, possible):
                count[verdict] = count.get(verdict, 0) + 1
                texts = "; ".join(symptom["what"] for symptom in answer["symptoms"])
                place = f"{layout:14} {scene:10} {pathlib.Path(relative).name:10}"
                print(f"{place} {name:24} {verdict:7} {measures(answer)}  {texts[:400]}", flush=True)
                record(flags, name, verdict, answer)
    print()
    for scene, count in counts.items():
        print(f"{scene:24}" + "  ".join(f"{verdict} {number}" for verdict, number in sorted(count.items())))
    return 1 if any("WRONG" in count or "ALARM" in count for count in counts.values()) else 0


if __name__ == "__main__":
    main()
