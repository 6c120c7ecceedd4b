"""Methods and odometry, scan by scan."""

import pickle
import threading

import numpy as np
import pytest

import mosbench

IDENTITY = np.eye(4)


def labels_of(scans, config, **options):
    mos = mosbench.MOS(config, **options)
    results = [result for scan in scans for result in mos.push(scan.points, scan.pose)] + mos.finish()
    assert [result.index for result in results] == list(range(len(results)))
    return [result.labels for result in results]


def test_gives_the_labels_of_the_program(street, near, finished):
    sequence = mosbench.open(street)
    for threads in (1, 2):
        labels = labels_of(sequence, near, threads=threads, scan_count=len(sequence))
        assert len(labels) == len(sequence) == 12
        for scan, ours in zip(sequence, labels):
            assert np.array_equal(ours, finished["08"].labels(scan.stem))


def test_casts_rays_from_the_origins_of_points(street, near):
    scans = list(mosbench.open(street))
    assert all(scan.origins is None for scan in scans)
    expected = labels_of(scans, near)
    mos, apart = mosbench.MOS(near), mosbench.MOS(near)
    differs = False
    for scan, labels in zip(scans, expected):
        here = np.zeros((len(scan.points), 3))
        assert np.array_equal(mos.push(scan.points, scan.pose, here)[0].labels, labels)
        there = here + [0.0, 0.0, 1.5] * (np.arange(len(here)) % 2)[:, None]
        differs |= not np.array_equal(apart.push(scan.points, scan.pose, there)[0].labels, labels)
    assert differs
    points, pose = scans[0].points, scans[0].pose
    for wrong, says in (
        (np.zeros((3, 3)), "one index of them per point"),
        (np.zeros(len(points)), r"origins: has shape"),
        (np.arange(3.0 * len(points)).reshape(-1, 3), "expected at most 256"),
    ):
        with pytest.raises(ValueError, match=says):
            mosbench.MOS(near).push(points, pose, wrong)
    with pytest.raises(ValueError, match="looks from one place"):
        mosbench.MOS(method="yoon").push(points, pose, np.zeros((len(points), 3)))


def test_refuses_a_config_of_another_method():
    with pytest.raises(ValueError, match="method: is dufomap, expected hmm-mos"):
        mosbench.MOS(mosbench.Config.preset("doals-20m"), method="dufomap")
    with pytest.raises(ValueError, match="config: is a text"):
        mosbench.MOS("doals-20m")


def test_takes_rows_of_three_or_four_numbers_of_any_type_and_stride(street, near):
    scans = list(mosbench.open(street))
    expected = labels_of(scans, near)
    assert any((labels == mosbench.MOVING_LABEL).any() for labels in expected)
    for change in (
        lambda p: p[:, :3],
        lambda p: p.astype(np.float64),
        np.asfortranarray,
        lambda p: np.repeat(p, 2, axis=0)[::2],
        lambda p: p.tolist(),
    ):
        mos = mosbench.MOS(near)
        labels = [mos.push(change(scan.points), scan.pose.tolist())[0].labels for scan in scans]
        assert all(np.array_equal(a, b) for a, b in zip(labels, expected))


def test_takes_what_speaks_dlpack(wall):
    class Tensor:
        def __dlpack__(self, stream=None):
            return wall.__dlpack__()

        def __dlpack_device__(self):
            return wall.__dlpack_device__()

    assert len(mosbench.MOS().push(Tensor(), IDENTITY)[0].labels) == len(wall)


def test_refuses_wrong_shapes_poses_settings_and_calls(wall):
    mos = mosbench.MOS()
    with pytest.raises(ValueError, match=r"points: has shape \(400, 2\), expected \(N, 3\) or \(N, 4\)"):
        mos.push(wall[:, :2], IDENTITY)
    with pytest.raises(ValueError, match="points: has type object, expected numbers"):
        mos.push(None, IDENTITY)
    with pytest.raises(ValueError, match="points: has type <U1"):
        mos.push([["a", "b", "c"]], IDENTITY)
    with pytest.raises(ValueError, match="pose: has shape"):
        mos.push(wall, np.eye(3))
    with pytest.raises(ValueError, match="last row"):
        mos.push(wall, np.ones((4, 4)))
    with pytest.raises(ValueError, match="rigid"):
        mos.push(wall, np.diag([3.0, 3.0, 3.0, 1.0]))
    with pytest.raises(ValueError, match="voxel_size_m"):
        mosbench.Config(voxel_size_m=-1)
    with pytest.raises(ValueError, match="nothing_m"):
        mosbench.Config(nothing_m=1)
    with pytest.raises(ValueError, match="not known"):
        mosbench.MOS(method="nothing")
    with pytest.raises(ValueError, match="threads"):
        mosbench.MOS(threads=0)
    mos.finish()
    with pytest.raises(ValueError, match="after finish"):
        mos.push(wall, IDENTITY)


def test_preset_best_is_of_plus():
    best = mosbench.Config.preset("best")
    assert best.method == "hmm-mos-plus" and best == mosbench.Config("hmm-mos-plus")
    assert mosbench.Config.preset("doals-20m").method == "hmm-mos"
    with pytest.raises(ValueError, match="preset best: is of method hmm-mos-plus"):
        mosbench.Config.preset("best", method="dynablox")


def test_settings_of_best_on_a_data_set_are_had_by_its_preset_and_the_method(tmp_path):
    mosbench.simulate(tmp_path / "sim", layout="semantickitti", scene="room", scans=2, seed=1)
    ran = mosbench.run(tmp_path / "sim", preset="best", out=tmp_path / "run").header["settings"]
    config = mosbench.Config.preset("semantickitti", method="hmm-mos-plus")
    assert config.items() <= ran.items()  # the run adds what follows from them


def test_config_replaces_copies_loads_and_compares(tmp_path):
    config = mosbench.Config.preset("doals-20m")
    finer = config.replace(voxel_size_m=0.1, delay_scans=np.int64(3))
    assert config["voxel_size_m"] == 0.2 and finer["voxel_size_m"] == 0.1 and finer["delay_scans"] == 3
    assert config != finer and finer == finer.replace()
    file = tmp_path / "near.json"
    file.write_text('{"max_range_m": 30}')
    assert mosbench.Config.load(file)["max_range_m"] == 30.0
    assert mosbench.Config(**config.to_dict()) == config
    file.write_text("{")
    with pytest.raises(ValueError, match="near.json"):
        mosbench.Config.load(file)


def test_delayed_labels_come_later_and_scores_when_asked(wall):
    mos = mosbench.MOS({"delay_scans": 2}, scores=True)
    assert [len(mos.push(wall, IDENTITY)) for _ in range(4)] == [0, 0, 1, 1]
    last = mos.finish()
    assert [result.index for result in last] == [2, 3]
    assert last[0].scores.dtype == np.float32 and last[0].scores.shape == (400,)
    assert mosbench.MOS().push(wall, IDENTITY)[0].scores is None


def test_reasons_come_with_scores_of_hmm_mos_plus(street):
    for method, scores, expected in (("hmm-mos-plus", True, True), ("hmm-mos-plus", False, False), ("hmm-mos", True, False)):
        mos = mosbench.MOS(method=method, scores=scores)
        results = [mos.push(scan.points, scan.pose)[0] for scan in mosbench.open(street)]
        assert all((result.reasons is not None) == expected for result in results)
        if not expected:
            continue
        assert all(result.reasons.dtype == np.uint8 for result in results)
        assert all(((result.reasons > 0) == result.moving).all() for result in results)
        assert {1, 3} <= set(np.concatenate([result.reasons for result in results]))


def test_objects_come_from_methods_that_find_them(street):
    for method, expected in (("hmm-mos", False), ("dynablox", True)):
        mos = mosbench.MOS(method=method)
        for scan in mosbench.open(street):
            result = mos.push(scan.points, scan.pose)[0]
        assert (result.objects is not None) == expected
    assert result.objects.dtype == np.uint32 and result.objects.shape == result.labels.shape


def test_results_outlive_the_method(wall):
    result = mosbench.MOS().push(wall, IDENTITY)[0]
    assert (result.labels == mosbench.STATIC_LABEL).all() and not result.moving.any()


def test_threads_may_push_to_methods_of_their_own(street, near):
    scans = list(mosbench.open(street))
    expected = labels_of(scans, near)
    found = {}

    def work(name):
        found[name] = labels_of(scans, near)

    threads = [threading.Thread(target=work, args=(name,)) for name in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for labels in found.values():
        assert all(np.array_equal(a, b) for a, b in zip(labels, expected))
    assert len(found) == 3


def test_odometry_finds_poses_near_the_true_ones(street):
    sequence = mosbench.open(street)
    poses = mosbench.odometry(sequence, min_range_m=1.5)
    truth = np.linalg.inv(sequence.gt_poses[0]) @ sequence.gt_poses
    assert poses.shape == (12, 4, 4)
    assert np.linalg.norm(truth[-1][:3, 3]) > 0.5
    assert np.linalg.norm((poses - truth)[:, :3, 3], axis=1).max() < 0.2
    errors = mosbench.evaluate_trajectory(poses, truth, align="origin")
    assert errors["sequences"][0]["absolute"]["translation_m"]["rmse"] < 0.2


def test_takes_memory_that_is_not_aligned(wall):
    """numpy.frombuffer gives such arrays when a header precedes the points."""
    unaligned = np.frombuffer(b"x" + wall.tobytes(), dtype=np.float32, offset=1).reshape(-1, 4)
    assert not unaligned.flags.aligned
    assert (mosbench.MOS().push(unaligned, IDENTITY)[0].labels == mosbench.STATIC_LABEL).all()


def test_every_method_labels(wall):
    assert "hmm-mos" in mosbench.methods()
    for method in mosbench.methods():
        mos = mosbench.MOS(method=method, scan_count=2)
        results = [*mos.push(wall, IDENTITY), *mos.push(wall, IDENTITY), *mos.finish()]
        assert [len(result.labels) for result in results] == [400, 400], method
        assert mos.memory_bytes is None or mos.memory_bytes > 0


def test_a_method_says_its_preset_its_range_and_what_differs_from_the_defaults():
    plain = mosbench.MOS()
    assert plain.range_m == (0.5, 20.0)
    assert repr(plain) == "MOS('hmm-mos', no preset: the method's defaults, judges 0.5 to 20 m)"
    config = mosbench.Config.preset("semantickitti").replace(delay_scans=3)
    mos = mosbench.MOS(config)
    assert mos.config.preset_name == "semantickitti" and "preset 'semantickitti'" in repr(mos)
    assert "judges 1.5 to 50 m" in repr(mos) and "delay_scans=3" in repr(mos)
    changed = config.changed()
    assert changed == {name: value for name, value in config.items() if mosbench.Config()[name] != value}
    assert all(f"{name}={value!r}" in repr(mos) for name, value in changed.items())
    assert pickle.loads(pickle.dumps(config)).preset_name == "semantickitti"
