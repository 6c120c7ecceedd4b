"""Labels from Python are those of the authors' program, and so of mosbench, bit for bit."""

import fcntl
import hashlib
import json
import os
import pathlib
import subprocess

import numpy as np
import pytest

import mosbench

SOURCE = pathlib.Path(__file__).resolve().parents[2]
PARITY = pathlib.Path(os.environ.get("MOSBENCH_SHARED", SOURCE / "../shared")) / "parity"
CASES = sorted(file.parent.name for file in PARITY.glob("cases/*/case.json"))

# name, scene, scans, settings and SHA-256 of all labels as tests/golden/simulated_labels_test.cpp has them.
SIMULATED = [
    ("campus_0", "campus", 60, {"voxel_size_m": 0.25, "min_range_m": 3.0, "max_range_m": 50.0},
     "2678093a024807a52297e1ebd10f1a2a930230c4edb27a8ede36b3b978270bb5"),
    ("street_0", "street", 40, {"voxel_size_m": 0.25, "min_range_m": 1.5, "max_range_m": 50.0},
     "34f16e4a96772d1e57fbf01a09e8fcc384a515f5ccaa3b982dff174d063a04a5"),
    ("highway_10", "highway", 30,
     {"voxel_size_m": 0.25, "min_range_m": 1.5, "max_range_m": 50.0, "delay_scans": 10},
     "9dcb676e458b47e702c2d1cadea18399d533b8d386a6a592a23fc9fb11ab9547"),
    ("mall_0", "mall", 40, {"voxel_size_m": 0.2, "min_range_m": 0.5, "max_range_m": 20.0},
     "b7ed807d670debb34646d73e6935dd61c4c7676a15b550e80fa8d014e9997b97"),
]  # fmt: skip


def poses_of(file):
    rows = np.loadtxt(file).reshape(-1, 3, 4)
    poses = np.tile(np.eye(4), (len(rows), 1, 1))
    poses[:, :3] = rows
    return poses


def labels_of(config, files, poses):
    """Returns the labels of all scans, in order."""
    mos = mosbench.MOS(config, scan_count=len(files))
    results = []
    for file, pose in zip(files, poses):
        results += mos.push(np.fromfile(file, dtype=np.float32).reshape(-1, 4), pose)
    results += mos.finish()
    assert [result.index for result in results] == list(range(len(files)))
    return [result.labels for result in results]


@pytest.fixture(scope="session")
def unpacked(tmp_path_factory):
    """The folder that the golden tests in C++ share, unpacked by whichever comes first."""
    build = pathlib.Path(os.environ.get("MOSBENCH_BINARY_DIR") or tmp_path_factory.mktemp("parity"))
    with open(build / "parity.lock", "a") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        subprocess.run([PARITY / "unpack.sh", build / "parity"], check=True)
    return build / "parity"


@pytest.mark.skipif(not CASES, reason="../shared/parity is not there")
@pytest.mark.parametrize("name", CASES)
def test_labels_equal_the_authors_program_on_every_case(name, unpacked):
    case = json.loads((PARITY / "cases" / name / "case.json").read_text())
    sequence = unpacked / "sequences" / case["sequence"]
    files = sorted(sequence.glob("velodyne/*.bin"))
    assert len(files) == case["scans"]
    config = mosbench.Config(variant=case["variant"], **case["config"])
    labels = labels_of(config, files, poses_of(sequence / "poses.txt"))
    for file, ours in zip(files, labels):
        expected = np.fromfile(unpacked / "cases" / name / "expected" / f"{file.stem}.label", dtype=np.uint32)
        assert np.array_equal(ours, expected), file.stem
    moving = sum(int((ours == mosbench.MOVING_LABEL).sum()) for ours in labels)
    assert moving == case["predicted_moving_points"] > 0


@pytest.mark.parametrize("name, scene, scans, settings, sha256", SIMULATED, ids=[case[0] for case in SIMULATED])
def test_labels_equal_the_authors_program_on_simulated_drives(name, scene, scans, settings, sha256, tmp_path):
    drive = mosbench.simulate(tmp_path / "drive", scene=scene, scans=scans) / "sequences/08"
    poses = poses_of(SOURCE / "tests/golden/simulated" / f"{name}.poses.txt")
    labels = labels_of(mosbench.Config(**settings), sorted(drive.glob("velodyne/*.bin")), poses)
    assert hashlib.sha256(b"".join(ours.tobytes() for ours in labels)).hexdigest() == sha256
