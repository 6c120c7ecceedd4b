"""Files of OpenSceneFlow as its own scripts write them, by h5py."""

import os
import pathlib
import shutil
import subprocess
import sys

import numpy as np
import pytest

import mosbench

h5py = pytest.importorskip("h5py")

POINTS = 500
START_NS = 315_969_904_359_876_000


def drive(seed=3, scans=4):
    """[{array: values}] of a car that turns, with the truth that OpenSceneFlow would count as `moving`."""
    random = np.random.default_rng(seed)
    made = []
    for k in range(scans):
        angle = 0.03 * k
        pose = np.eye(4)
        pose[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
        pose[:3, 3] = 1.2 * k, 0.1 * k * k, 0.0
        made.append({"lidar": random.uniform(-60, 60, (POINTS, 3)).astype(np.float32), "pose": pose})
    for now, following in zip(made, made[1:]):
        motion = np.linalg.inv(following["pose"]) @ now["pose"]
        points = now["lidar"].astype(np.float64)
        rigid = points @ motion[:3, :3].T + motion[:3, 3] - points
        objects = random.integers(0, 4, POINTS)
        # Away from the limit of 0.05 m.
        moved = np.array([0.0, 0.03, 0.07, 2.0])[objects]
        now["flow"] = (rigid + moved[:, None] * [0.6, 0.8, 0.0]).astype(np.float32)
        now["flow_is_valid"] = random.random(POINTS) > 0.1
        now["flow_category_indices"] = np.where(objects > 0, random.integers(29, 32, POINTS), 0).astype(np.uint8)
        now["flow_instance_id"] = objects.astype(np.int16)
        now["ego_motion"] = motion.astype(np.float32)
        now["moving"] = np.linalg.norm(now["flow"] - rigid, axis=1) >= 0.05
        now["counted"] = now["flow_is_valid"] & (now["flow_category_indices"] <= 30)
    for scan in made:
        scan["ground_mask"] = scan["lidar"][:, 2] < -20
    return made


TOLD = ("moving", "counted")  # not of the file


def write(file, scans, step_ns=10**8, **storage):
    with h5py.File(file, "w") as out:
        for k, scan in enumerate(scans):
            group = out.create_group(str(START_NS + k * step_ns))
            for name, values in scan.items():
                if name not in TOLD:
                    group.create_dataset(name, data=values, **(storage if values.shape != (4, 4) else {}))
    return file


def opened(file):
    try:
        return mosbench.open(file)
    except OSError as error:
        if "this build reads" in str(error):
            pytest.skip("this build is without libhdf5")
        raise


def check(file, scans):
    sequence = opened(file)
    assert len(sequence) == len(scans) and sequence.name == "scene"
    for k, scan in enumerate(scans):
        found = sequence.scan(k)
        assert found.stamp_ns == START_NS + k * 10**8 and found.stem == str(found.stamp_ns)
        assert np.array_equal(found.points[:, :3], scan["lidar"])
        assert np.array_equal(found.pose, scan["pose"])
        if "flow" not in scan:
            assert found.truth is None
            continue
        seen = ~scan["ground_mask"] & scan["counted"]
        assert 0 < (seen & scan["moving"]).sum() < seen.sum() < POINTS
        ids = found.truth & 0xFFFF
        assert np.array_equal(ids == 251, seen & scan["moving"])
        assert np.array_equal(ids == 9, seen & ~scan["moving"])
        assert np.array_equal(ids == 0, ~scan["flow_is_valid"])
        assert np.array_equal((found.truth >> 16)[ids > 0], scan["flow_instance_id"][ids > 0])


def test_reads_what_openSceneFlow_writes(tmp_path):
    check(write(tmp_path / "scene.h5", drive()), drive())


@pytest.mark.parametrize("storage", [{"compression": "gzip"}, {"chunks": True, "shuffle": True, "fletcher32": True}])
def test_reads_packed_arrays(tmp_path, storage):
    check(write(tmp_path / "scene.h5", drive(), **storage), drive())


def test_reads_other_numbers_and_newer_files(tmp_path):
    scans = drive()
    with h5py.File(tmp_path / "scene.h5", "w", libver="latest") as out:
        for k, scan in enumerate(scans):
            group = out.create_group(str(START_NS + k * 10**8))
            for name, values in scan.items():
                if name in TOLD:
                    continue
                kind = {"f": ">f8" if name in ("lidar", "pose") else ">f4", "b": "?", "u": "u1", "i": ">i8"}[values.dtype.kind]
                group.create_dataset(name, data=values.astype(kind))
    check(tmp_path / "scene.h5", scans)


def test_microseconds_are_told_by_the_time_between_scans(tmp_path):
    with h5py.File(tmp_path / "scene.h5", "w") as out:
        for k, scan in enumerate(drive()):
            group = out.create_group(str(1_531_883_530_449_377 + 10**5 * k))
            group["lidar"], group["pose"] = scan["lidar"], scan["pose"].astype(np.float32)
    scan = opened(tmp_path / "scene.h5").scan(1)
    assert scan.stamp_ns == 1_531_883_530_549_377_000 and scan.truth is None


@pytest.mark.parametrize("step_ns", [5 * 10**7, 10**8, 101 * 10**6, 5 * 10**8])
@pytest.mark.parametrize("masked", [False, True])
def test_scores_dufo_as_openSceneFlow_scores_flow(tmp_path, masked, step_ns):
    scans = drive()
    random = np.random.default_rng(7)
    file = write(tmp_path / "scene.h5", scans, step_ns)
    opened(file)
    near, far = [], []
    with h5py.File(file, "r+") as out:
        for k, scan in enumerate(scans):
            group = out[str(START_NS + k * step_ns)]
            dufo = random.random(POINTS) > 0.5
            group.create_dataset("dufo", data=dufo.astype(np.uint8))
            mask = ~scan["ground_mask"]
            if masked and k == 1:
                evaluated = random.random(POINTS) > 0.5
                group.create_dataset("eval_mask", data=evaluated[:, None])
                mask &= evaluated
            if "flow" in scan and (k == 1 or not masked):
                close = np.all(np.abs(scan["lidar"][:, :2]) <= 35, axis=1)
                for ious, mask_ in ((near, mask & scan["counted"] & close), (far, mask & scan["counted"])):
                    both = (dufo & scan["moving"] & mask_).sum()
                    ious.append(both / ((dufo | scan["moving"]) & mask_).sum())
    assert len(near) == (1 if masked else 3) and near != far
    for protocol, ious in (("sceneflow-dynamic", near), ("sceneflow-dynamic-far", far)):
        result = mosbench.score(file, file, protocol=protocol)
        assert result.iou == pytest.approx(np.mean(ious), abs=1e-12)


def test_labels_of_a_method_are_filled_in_and_scored(tmp_path, near):
    simulated = mosbench.simulate(tmp_path / "sim", layout="opensceneflow", scene="street", scans=12)
    file = simulated / "street.h5"
    assert mosbench.moving_for_h5(file, near) == 12
    filled = mosbench.score(file, file)
    run = mosbench.run(file, config=near, out=tmp_path / "run")
    assert filled.iou == run.iou and 0 < run.iou < 1


@pytest.mark.parametrize("what", ["external", "virtual", "soft", "elsewhere"])
def test_numbers_of_other_places_are_refused(tmp_path, what):
    """A file of strangers must not name other files of this machine."""
    scans = drive()
    file, other = write(tmp_path / "scene.h5", scans), write(tmp_path / "other.h5", scans)
    opened(file)
    with h5py.File(file, "r+") as out:
        group = out[str(START_NS)]
        del group["lidar"]
        if what == "external":
            group.create_dataset("lidar", (POINTS, 3), "f4", external=[(str(other), 0, POINTS * 12)])
        elif what == "virtual":
            layout = h5py.VirtualLayout((POINTS, 3), "f4")
            layout[:] = h5py.VirtualSource(str(other), f"{START_NS}/lidar", (POINTS, 3))
            group.create_virtual_dataset("lidar", layout)
        elif what == "soft":
            group["lidar"] = h5py.SoftLink(f"/{START_NS + 10**8}/lidar")
        else:
            group["lidar"] = h5py.ExternalLink(str(other), f"{START_NS}/lidar")
    expected = "has no lidar" if what in ("soft", "elsewhere") else "has its numbers in other files"
    with pytest.raises(OSError, match=expected):
        mosbench.open(file)


def test_poses_too_coarse_for_the_flow_are_refused(tmp_path):
    def far(kind, with_ego_motion):
        scans = drive()
        for scan in scans:
            scan["pose"][:3, 3] += 4e5, 4e6, 0
            scan["pose"] = scan["pose"].astype(kind)
            if not with_ego_motion:
                scan.pop("ego_motion", None)
        return opened(write(tmp_path / "scene.h5", scans))

    with pytest.raises(OSError, match="pose is float32, 0.25 m apart at .* expected float64, or ego_motion"):
        far(np.float32, False).scan(0)
    for kind, with_ego_motion in ((np.float32, True), (np.float64, False)):
        ids = far(kind, with_ego_motion).scan(0).truth & 0xFFFF
        scan = drive()[0]
        seen = ~scan["ground_mask"] & scan["counted"]
        assert np.array_equal(ids == 251, seen & scan["moving"])


def test_a_wheel_has_the_module_of_libhdf5_beside_its_own(tmp_path):
    package = pathlib.Path(mosbench.__file__).parent
    module = package.parents[1] / "datasets/modules/mosbench_hdf5.so"
    if not module.exists():
        pytest.skip("this build has no libhdf5")
    wheel = tmp_path / "site/mosbench"
    shutil.copytree(package, wheel)
    shutil.copy(module, wheel)
    code = "import mosbench, sys; print(len(mosbench.open(sys.argv[1])), open('/proc/self/maps').read())"
    done = subprocess.run([sys.executable, "-c", code, write(tmp_path / "a.h5", drive())], capture_output=True, text=True,
                          env={**os.environ, "PYTHONPATH": str(wheel.parent)}, check=True)
    assert str(wheel / module.name) in done.stdout
