"""Every kind of input that mosbench reads: a tree in which some files are damaged, and commands that read them."""

import re
from dataclasses import dataclass

import folders

LAYOUTS = ("doals", "doals-bag", "sipailou", "helimos", "semantickitti", "opensceneflow", "nuscenes", "helipr",
           "kitti-raw", "kitti-tracking")
RUN = "run data --config config.json --threads 1 --out out"
READING = [
    RUN, f"{RUN} --json", f"{RUN} --perturb pose_noise_m=0.05,dropout_probability=0.2,fog_per_m=0.02,seed=3",
    f"{RUN} --scores --odometry kiss", "doctor data", "doctor data --json",
    "odometry data -o out.txt --threads 1", "odometry data -o out.tum --odometry kiss --json --threads 1",
    "profile data --scans 3 --json p.json -o t.json", *(f"convert data --layout {layout} --out out" for layout in LAYOUTS),
    "score data --predictions predicted --json", "score data --predictions predicted --protocol all",
    "breakdown data --predictions predicted --json",
]
JUDGING = [
    "stats run", "stats run --json", "stats run --csv", "stats run other_run --json", "compare run other_run --even-if",
    "compare baseline run --even-if --json", "bless run baseline --even-if", "bless run new", "report run -o r.html --scans none",
    "report run other_run -o r.html", "render run --scan worst -o r.png --size 200", "diff run other_run --json",
    "diff run other_run --data data", "breakdown data --predictions run", "table II run --format json", "table III run",
    "score data --predictions run --json", "run data --config config.json --scores --threads 1 --out run",
]


@dataclass(frozen=True)
class Kind:
    name: str
    tree: dict
    damaged: re.Pattern  # of the paths of files that are damaged
    commands: list


def _prefixed(trees, **places):
    tree = dict(trees["texts"])
    for place, name in places.items():
        tree |= folders.at(place, trees[name])
    return tree


def _scans(trees):
    for encoding in ("ascii", "binary_little_endian", "binary_big_endian"):
        tree = _prefixed(trees, data=f"ply_{encoding}", predicted="predicted_all")
        yield Kind(f"scan .ply {encoding}", tree, re.compile(r"\.ply$"), READING)
    for end, encodings in ((".ply", ("ascii", "binary_little_endian")), (".pcd", ("ascii", "binary"))):
        for encoding in encodings:
            tree = _prefixed(trees, data=f"timed{end}_{encoding}")
            timed = [f"{RUN} --point-times column", f"{RUN} --point-times column --deskew velocity"]
            yield Kind(f"scan {end} with times {encoding}", tree, re.compile(rf"^data/.*\{end}$"), timed)
    for encoding in ("ascii", "binary", "binary_compressed"):
        for layout in ("moe", "kth"):
            tree = _prefixed(trees, data=f"{layout}_{encoding}", predicted="predicted_all")
            yield Kind(f"{layout} .pcd {encoding}", tree, re.compile(r"^data/.*\.pcd$"), READING)
        clouds = sorted(name for name in trees[f"kth_{encoding}"] if name.startswith("00/pcd/"))
        yield Kind(f"map .pcd {encoding}", tree, re.compile(r"^data/.*\.pcd$"), [
            f"map-score data/{clouds[0]} data/{clouds[1]}", f"map-score data/{clouds[1]} data/{clouds[0]} --json"])
    tree = _prefixed(trees, data="moe_binary", predicted="predicted_all")
    yield Kind("moe label .txt", tree, re.compile(r"^data/.*/label/"), READING)
    for compression in ("none", "lz4", "bz2"):
        tree = _prefixed(trees, data=f"bag_{compression}", predicted="doals_run")
        yield Kind(f"bag {compression}", tree, re.compile(r"\.bag$"), [*READING, f"{RUN} --raw-scans"])
    for container, pattern in (("mcap", r"\.mcap$"), ("db3", r"\.db3$"), ("db3", r"metadata\.yaml$")):
        tree = _prefixed(trees, data=container)
        recording = [*READING[:READING.index("score data --predictions predicted --json")], f"{RUN} --raw-scans"]
        yield Kind(f"ROS 2 {pattern[2:-1]}", tree, re.compile(pattern), recording)


    flow = _prefixed(trees, data="opensceneflow")
    flow_commands = [*READING[:READING.index("score data --predictions predicted --json")], f"{RUN} --moving-speed-m-s 2",
                     "score data --predictions data --json --allow-missing"]
    yield Kind("OpenSceneFlow .h5", flow, re.compile(r"\.h5$"), flow_commands)


def _sequences(trees):
    kitti = _prefixed(trees, data="semantickitti", predicted="predicted_all")
    for name, pattern in (("scan .bin", r"\.bin$"), ("truth .label", r"^data/.*\.label$"), ("poses.txt", r"poses\.txt$"),
                          ("calib.txt", r"calib\.txt$"), ("times.txt", r"times\.txt$"),
                          ("simulated.json", r"simulated\.json$")):
        yield Kind(name, kitti, re.compile(pattern), READING)
    doals = _prefixed(trees, data="doals", predicted="doals_run")
    yield Kind("indices.csv", doals, re.compile(r"indices\.csv$"), READING)
    reproduce = "run table:{} --data data --out out --threads 1"
    yield Kind("data set doals", doals, re.compile(r"^data/"), [*READING, reproduce.format("doals")])
    for layout in ("sipailou", "helimos"):
        tree = _prefixed(trees, data=layout, predicted="predicted_all")
        yield Kind(f"data set {layout}", tree, re.compile(r"^data/"), [*READING, reproduce.format(layout)])
    for layout in ("apollo", "mdetector"):
        tree = _prefixed(trees, data=layout, predicted="predicted_all")
        commands = [line.replace(" data", f" data --dataset {layout}", 1) for line in READING]
        yield Kind(f"data set {layout}", tree, re.compile(r"^data/"), commands)
    nuscenes = _prefixed(trees, data="nuscenes", predicted="predicted_all")
    for name, pattern in (("tables of nuscenes", r"^data/.*v1.0-mini/.*\.json$"), ("scan .pcd.bin", r"\.pcd\.bin$")):
        yield Kind(name, nuscenes, re.compile(pattern), READING)
    helipr = _prefixed(trees, data="helipr")
    for name, pattern in (("scan of helipr", r"LiDAR/.*\.bin$"), ("poses of helipr", r"_gt\.txt$")):
        yield Kind(name, helipr, re.compile(pattern), READING[:READING.index("score data --predictions predicted --json")])
    drives = [*READING[:READING.index("score data --predictions predicted --json")], f"{RUN} --moving-speed-m-s 2"]
    for layout, pattern in (("kitti-raw", r"tracklet_labels\.xml$"), ("kitti-raw", r"timestamps\.txt$"),
                            ("kitti-raw", r"oxts/data/.*\.txt$"), ("kitti-raw", r"calib_\w+\.txt$"),
                            ("kitti-raw", r"\.bin$"), ("kitti-tracking", r"label_02/.*\.txt$"),
                            ("kitti-tracking", r"oxts/\d+\.txt$"), ("kitti-tracking", r"calib/.*\.txt$")):
        yield Kind(f"{layout} {pattern.rstrip('$')}", _prefixed(trees, data=layout), re.compile(pattern), drives)
    helimos = _prefixed(trees, data="helimos", predicted="predicted_all")
    splits = [f"{RUN} --protocol helimos-test", "score data --predictions predicted --protocol all", "doctor data",
              "score data --predictions predicted --split val --json"]
    yield Kind("split .txt", helimos, re.compile(r"(train|val|test)\.txt$"), splits)


def _poses(trees):
    tree = _prefixed(trees, data="semantickitti", poses="poses")
    for name in ("kitti.txt", "poses.tum", "rollout.csv"):
        yield Kind(f"poses {name}", tree, re.compile(rf"poses/{re.escape(name)}$"), [
            f"{RUN} --poses poses/{name}", f"doctor data --poses poses/{name}",
            f"convert data --poses poses/{name} --pose-frame camera --layout doals --out out",
            f"{RUN} --poses poses/{name} --pose-direction sensor-from-map",
            f"trajectory poses/{name} --truth poses/kitti.txt --json",
            f"trajectory poses/kitti.txt --truth poses/{name} --align rigid",
            f"trajectory poses/{name} --truth poses/poses.tum --delta 1m,all --by pose --json",
            "trajectory poses --truth poses --csv"])


def _predictions(trees):
    for form in ("label", "label-index", "label-masked", "text", "pcd", "csv"):
        tree = _prefixed(trees, data="semantickitti", predicted=f"predicted_{form}")
        score = "score data --predictions predicted"
        commands = [score, f"{score} --json", f"{score} --format {form}", f"{score} --allow-missing --out out",
                    f"{score} --protocol all --json", "breakdown data --predictions predicted"]
        yield Kind(f"predictions {form}", tree, re.compile("^predicted/"), commands)
    for form in ("rows", "indices", "dynablox-clouds", "dynablox-scores"):
        tree = _prefixed(trees, data="doals", predicted=f"predicted_{form}")
        score = "score data --protocol doals-dynablox --predictions predicted"
        commands = [score, f"{score} --json", f"{score} --format {form}", f"{score} --allow-missing --out out",
                    f"{score} --level point", "score data --predictions predicted --protocol all --json"]
        yield Kind(f"predictions {form}", tree, re.compile("^predicted/"), commands)


def _results(trees):
    tree = _prefixed(trees, data="semantickitti", run="run", other_run="other_run", baseline="baseline")
    yield Kind("result.json", tree, re.compile(r"^run/.*result\.json$"), JUDGING)
    yield Kind("baseline", tree, re.compile(r"^baseline/.*result\.json$"), [each for each in JUDGING if "baseline" in each])
    yield Kind("labels of a run", tree, re.compile(r"^run/.*\.label$"), JUDGING)
    scores = ["report run -o r.html", "render run --scan worst -o r.png --size 200", "run data --config config.json --scores --out run"]
    yield Kind("scores of a run", tree, re.compile(r"^run/.*\.score$"), scores)
    delayed = _prefixed(trees, data="semantickitti", run="delayed_run", other_run="scored", baseline="baseline")
    yield Kind("result.json delayed", delayed, re.compile(r"^run/.*result\.json$"), JUDGING)
    yield Kind("result.json of score", delayed, re.compile(r"^other_run/.*result\.json$"), JUDGING)
    doals = _prefixed(trees, data="doals", run="doals_run", other_run="doals_run", baseline="doals_run")
    yield Kind("result.json of doals", doals, re.compile(r"^run/.*result\.json$"),
               [*JUDGING, "table I run --format latex", "table I run --format csv"])


def _texts(trees, published):
    tree = _prefixed(trees, data="semantickitti")
    yield Kind("config", tree, re.compile("^config.json$"), [RUN, f"{RUN} --json", "profile data --config config.json"])
    odometry = tree | {"odometry.json": b'{"min_range_m": 1.0, "max_range_m": 60.0}'}
    yield Kind("odometry config", odometry, re.compile("^odometry.json$"), [
        "odometry data --config odometry.json -o out.txt --threads 1",
        f"{RUN} --odometry simple --odometry-config odometry.json"])
    layouts = [f"simulate --layout {layout} --scene scene.json --scans 2 --seed 1 --threads 1 --out out"
               for layout in ("doals", "sipailou", "semantickitti", "opensceneflow")]
    yield Kind("scene", tree, re.compile("^scene.json$"), layouts)
    yield Kind("study", tree, re.compile("^study.yaml$"), [
        "run study.yaml --dry-run --out out", "run study.yaml --dry-run --json --out out", "rank study.yaml --out out"])
    rows = _prefixed(trees, run="doals_run") | {"published.csv": published}
    yield Kind("published rows", rows, re.compile("^published.csv$"), [
        f"table {name} run --published published.csv --format {form}"
        for name in ("I", "II", "moe") for form in ("markdown", "csv", "latex", "json")])


def kinds(trees, published):
    """All kinds, in an order that never changes: a case's number chooses one."""
    found = [*_scans(trees), *_sequences(trees), *_poses(trees), *_predictions(trees), *_results(trees), *_texts(trees, published)]
    for kind in found:
        assert any(kind.damaged.search(name) for name in kind.tree), f"{kind.name}: nothing to damage"
    return found


def everything(trees):
    """One tree with an input of most kinds, for damaged command lines."""
    tree = _prefixed(trees, data="semantickitti", run="run", other_run="other_run", baseline="baseline")
    return tree | folders.at("poses", trees["poses"])
