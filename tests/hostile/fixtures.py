"""Makes the small inputs that the drivers damage, with the program itself where it can write them."""

import json
import os
import re

import folders
import formats
import program

WALL = {"shape": "box", "size_m": [10, 0.2, 2.8]}
SCENE = {
    "name": "station",
    "sensor": "vlp-16",
    "columns": 16,
    "range_noise_m": 0.01,
    "dropout_probability": 0.3,
    "ego": {"carrier": "ground-robot", "sensor_height_m": 0.8,
            "route": {"from_m": [-1, 0], "legs": [{"to_m": [1, 0], "speed_m_s": 1.5}], "after": "return"}},
    "ground": [{"height_m": 0, "slope_x": 0.01}],
    "structures": [
        {**WALL, "center_m": [0, 4, 1.4]},
        {**WALL, "center_m": [0, -4, 1.4]},
        {**WALL, "center_m": [5, 0, 1.4], "yaw_rad": 1.57, "labelled": False},
        {"shape": "cylinder", "size_m": [1, 1, 2], "center_m": [-3, 2, 1], "density": 0.5},
    ],
    "movers": [{"kind": "car", "route": {"from_m": [3, -6], "legs": [{"to_m": [3, 6], "speed_m_s": 12}],
                                         "after": "return"}}],
    "doors": [{"hinge_m": [-0.6, -3.8], "period_s": 0.5, "swing_s": 0.2}],
    "balls": [{"from_m": [2, -2, 1.2], "velocity_m_s": [-3.5, 0.5, 3], "period_s": 0.4}],
}
STUDY = """name: hostile
data: {name: drive, path: data}
methods: [hmm-mos, {name: near, method: dynablox, set: {max_range_m: 8}}]
odometry: [none, kiss]
disturb:
  - {kind: pose_noise_m, strengths: [0.05, 0.2]}
vary: [{setting: voxel_size_m, values: [0.4, 0.5]}]
seeds: [1, 2]
"""
SCANS = 8
# Settings with which even so few points make something move.
CONFIG = {"voxel_size_m": 0.5, "kernel_width_voxels": 1, "min_otsu_score": 0, "min_state_probability": 0.9,
          "local_window_scans": 2, "max_range_m": 10}
OTHER_CONFIG = {**CONFIG, "voxel_size_m": 0.4}
SEQUENCE = "sequences/08"
DOALS_SEQUENCE = "station/sequence_1"


class NotWhole(Exception):
    """The program cannot even do its work on good inputs."""


def _steady(value):
    """A measured number becomes a fixed one, so that a seed damages the same bytes on every machine."""
    if isinstance(value, dict):
        return {key: _steady(each) for key, each in value.items()}
    if isinstance(value, list):
        return [_steady(each) for each in value]
    return 0.25 if isinstance(value, float) else value


def _steady_result(data):
    result = json.loads(data)
    if "timing" in result:
        result["timing"] = _steady(result["timing"])
    if "places" in result:
        result["places"]["dataset_root"] = "data"
        if "predictions" in result["places"]:
            result["places"]["predictions"]["path"] = "run"
    if "machine" in result.get("provenance", {}):
        result["provenance"]["machine"] = {"processor": "one", "logical_cores": 2, "memory_mib": 4096.0, "system": "Linux x86_64"}
    return json.dumps(result, indent=1).encode()


class Maker:
    """Runs commands of the program in one folder."""

    def __init__(self, program_path, folder):
        self.program, self.folder = program_path, folder
        self.texts = {
            "scene.json": json.dumps(SCENE, indent=1).encode(),
            "config.json": json.dumps(CONFIG).encode(),
            "other.json": json.dumps(OTHER_CONFIG).encode(),
            "study.yaml": STUDY.encode(),
        }
        folders.renew(folder, self.texts)

    def make(self, name, line):
        """Runs a command that writes the folder `name`, and returns its tree."""
        ended = program.run(self.program, f"{line} {name}".split(), self.folder)
        if ended.code not in (0, 1) or program.fault_of(ended):
            raise NotWhole(f"mosbench {line} {name}: exit code {ended.code}: {ended.err}")
        tree = folders.load(os.path.join(self.folder, name))
        if not tree:
            raise NotWhole(f"mosbench {line} {name}: wrote nothing")
        return {path: _steady_result(data) if path.endswith("result.json") else data for path, data in tree.items()}

    def put(self, name, tree):
        folders.write(os.path.join(self.folder, name), tree)
        return tree


def _lidar_poses(trees):
    return trees["doals"][f"{DOALS_SEQUENCE}/poses.txt"]


def _simulated(maker):
    trees = {}
    for layout in ("semantickitti", "sipailou", "doals"):
        trees[layout] = maker.make(
            layout, f"simulate --layout {layout} --scene scene.json --scans {SCANS} --seed 1 --threads 1 --out")
    for compression in ("none", "lz4", "bz2"):
        trees[f"bag_{compression}"] = maker.make(
            f"bag_{compression}", f"convert doals --layout doals-bag --compression {compression} --out")
    trees["opensceneflow"] = maker.make(
        "opensceneflow", f"simulate --layout opensceneflow --scene scene.json --scans {SCANS} --seed 1 --threads 1 --out")
    for container in ("mcap", "db3"):
        trees[container] = maker.make(container, f"convert doals --layout ros2-{container} --out")
    for layout in ("nuscenes", "helipr", "kitti-raw", "kitti-tracking"):
        trees[layout] = maker.make(layout, f"convert semantickitti --layout {layout} --out")
    return trees


def _scans_of(kitti):
    """{stem: (points, labels)} of a sequence in KITTI's layout."""
    return {
        name[9:-4]: (formats.points_of(data), formats.labels_of(kitti[f"labels/{name[9:-4]}.label"]))
        for name, data in kitti.items() if name.startswith("velodyne/")
    }


def _rewritten(trees):
    """The same sequence in layouts and files that the program only reads."""
    kitti = folders.below(trees["semantickitti"], SEQUENCE)
    poses = _lidar_poses(trees)
    scans = _scans_of(kitti)
    rest = {name: data for name, data in kitti.items() if not name.startswith("velodyne/")}
    numbers = "".join(f"{i}\n" for i in range(SCANS)).encode()
    made = {
        "apollo": folders.at(SEQUENCE, {**kitti, "velodyne_poses_kitti.txt": poses}),
        "mdetector": folders.at(SEQUENCE, kitti),
        "helimos": {f"{split}.txt": numbers for split in ("train", "val", "test")},
    }
    for sensor in ("Avia", "Velodyne"):
        made["helimos"] |= folders.at(sensor, {**kitti, "poses.txt": poses})
    for encoding in ("ascii", "binary", "binary_compressed"):
        made[f"moe_{encoding}"] = {"00/gt_poses.txt": poses}
        made[f"kth_{encoding}"] = {"00/gt_cloud.pcd": b""}
        for stem, (points, labels) in scans.items():
            made[f"moe_{encoding}"][f"00/pcd/{stem}.pcd"] = formats.pcd(points, encoding)
            made[f"moe_{encoding}"][f"00/label/{stem}.txt"] = formats.moe_labels(labels)
            made[f"kth_{encoding}"][f"00/pcd/{stem}.pcd"] = formats.truth_pcd(points, labels, encoding)
    for encoding in ("ascii", "binary_little_endian", "binary_big_endian"):
        clouds = {f"velodyne/{stem}.ply": formats.ply(points, encoding) for stem, (points, _) in scans.items()}
        made[f"ply_{encoding}"] = folders.at(SEQUENCE, {**rest, **clouds})
    for end, timed, encodings in ((".ply", formats.timed_ply, ("ascii", "binary_little_endian")),
                                  (".pcd", formats.timed_pcd, ("ascii", "binary"))):
        for encoding in encodings:
            clouds = {f"velodyne/{stem}{end}": timed(points, encoding) for stem, (points, _) in scans.items()}
            made[f"timed{end}_{encoding}"] = folders.at(SEQUENCE, {**rest, **clouds})
    return made


def _predictions_per_scan(trees):
    scans = _scans_of(folders.below(trees["semantickitti"], SEQUENCE))
    made = {name: {} for name in ("label", "label-index", "label-masked", "text", "pcd", "csv")}
    for position, (stem, (points, labels)) in enumerate(sorted(scans.items())):
        made["label"][f"{stem}.label"] = formats.label_file(labels)
        made["label-index"][f"{position:06d}.label"] = formats.label_file(labels)
        far = [label for point, label in zip(points, labels) if sum(x * x for x in point[:3]) >= 16.0]
        made["label-masked"][f"{stem}.label"] = formats.label_file(far)
        made["text"][f"{stem}.txt"] = formats.moe_labels(labels)
        made["pcd"][f"{stem}.pcd"] = formats.truth_pcd(points, labels, "binary")
        made["csv"][f"{stem}.csv"] = formats.moving_csv(labels)
    for sequence in ("00", "06", "08", "Avia", "Velodyne"):
        made["all"] = made.get("all", {}) | folders.at(f"{sequence}/labels", made["label"])
    return made


def _predictions_in_one_file(trees):
    doals = folders.below(trees["doals"], DOALS_SEQUENCE)
    stamps = [line.replace(".", "") for line in doals["times.txt"].decode().split()]
    rows = [line.split(",") for line in doals["indices.csv"].decode().split()]
    moving = {stamp: set(map(int, indices)) for stamp, *indices in rows}
    truth = [(stamp, formats.points_of(doals[f"velodyne/{stamps.index(stamp):06d}.bin"]), moving[stamp])
             for stamp in sorted(moving)]
    numbered = ((number, moving.get(stamp, ())) for number, stamp in enumerate(stamps, 1))
    return {
        "rows": {"station/sequence_1.txt": formats.rows(numbered)},
        "indices": {"indices.csv": formats.rows(moving.items())},
        # Dynablox writes both, and the stamps of the clouds are those of the scores.
        "dynablox-clouds": {"clouds.csv": formats.dynablox_clouds([each[1:] for each in truth]),
                            "scores.csv": formats.dynablox_scores(truth)},
        "dynablox-scores": {"scores.csv": formats.dynablox_scores(truth)},
    }


def _results(maker):
    run = "run semantickitti --config {} --threads 1 --scores --out"
    trees = {
        "run": maker.make("run", run.format("config.json")),
        "other_run": maker.make("other_run", run.format("other.json")),
        "doals_run": maker.make("doals_run", "run doals --config config.json --threads 1 --out"),
        "delayed_run": maker.make("delayed_run", "run semantickitti --set delay_scans=2 --threads 1 --out"),
    }
    trees["baseline"] = maker.make("baseline", "bless run")
    trees["scored"] = maker.make("scored", "score semantickitti --method other --predictions run --out")
    return trees


def _poses(maker, trees):
    """Poses in every format, of semantickitti and as estimates."""
    stamps = trees["doals"][f"{DOALS_SEQUENCE}/times.txt"].decode().split()
    poses = _lidar_poses(trees)
    times = trees["semantickitti"][f"{SEQUENCE}/times.txt"].decode().split()
    return {
        "kitti.txt": poses,
        "poses.tum": formats.tum(poses, times),
        "doals.tum": formats.tum(poses, stamps),
        "rollout.csv": formats.rollout(poses),
    }


def make(program_path, folder):
    """{name: tree} of everything; raises NotWhole when the program fails on good inputs."""
    maker = Maker(program_path, folder)
    trees = _simulated(maker)
    trees |= _rewritten(trees)
    for name, tree in {**_predictions_per_scan(trees), **_predictions_in_one_file(trees)}.items():
        trees[f"predicted_{name}"] = tree
    trees |= _results(maker)
    trees["poses"] = _poses(maker, trees)
    trees["texts"] = maker.texts
    result = json.loads(trees["run"]["08/result.json"])
    if not 0 < result["summary"]["iou"] < 1 or not re.search(b"[^\0]", trees["run"]["08/scores/000007.score"]):
        raise NotWhole("the small run moves nothing, or everything right")
    return trees
