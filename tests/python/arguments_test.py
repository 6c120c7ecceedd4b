"""Wrong arguments are refused in a line, and right ones are what they say."""

import copy
import pickle

import numpy as np
import pytest

import mosbench

IDENTITY = np.eye(4)


@pytest.mark.parametrize(
    "call, error, message",
    [
        (lambda: mosbench.MOS(threads=-3), ValueError, "threads: is -3, expected 1 to 1024"),
        (lambda: mosbench.MOS(threads="2"), TypeError, "threads: is '2', expected a whole number"),
        (lambda: mosbench.MOS(threads=2**40), ValueError, "threads: is 1099511627776, expected 1 to 1024"),
        (lambda: mosbench.MOS(scan_count=-1), ValueError, "scan_count: is -1, expected 0 or more"),
        (lambda: mosbench.MOS(3), TypeError, "config: is int, expected a Config, or settings by name"),
        (lambda: mosbench.Odometry(threads=1.5), TypeError, "threads: is 1.5, expected a whole number"),
        (lambda: mosbench.Odometry().push(np.ones((9, 3)), stamp_ns=1.5), TypeError, "stamp_ns: is 1.5, expected"),
        (lambda: mosbench.Odometry(min_range_m=None), TypeError, "min_range_m: is None, expected a number or a name"),
        (lambda: mosbench.Odometry().push(np.ones((1, 3)), 0, [np.nan]), ValueError, "point_times_ns: has shape"),
        (lambda: mosbench.Config(voxel_size_m=None), TypeError, "voxel_size_m: is None, expected a number or a name"),
        (lambda: mosbench.Config(p_min=0.9), ValueError, "setting: 'p_min' is not known, expected min_state_probab"),
        (lambda: mosbench.Config.preset("doals-20"), ValueError, "preset: 'doals-20' is not known"),
        (lambda: mosbench.simulate("nowhere", seed=-1), ValueError, "seed: is -1, expected 0 or more"),
        (lambda: mosbench.simulate("nowhere", scans=1.5), TypeError, "scans: is 1.5, expected a whole number"),
        (lambda: mosbench.run("nowhere", config="c.json"), ValueError, r"config: is a text, .*Config\.load"),
        (lambda: mosbench.run("nowhere", preset="kth", config=mosbench.Config()), ValueError, "preset: is given beside"),
        (lambda: mosbench.score("nowhere", "p", protocol="all"), ValueError, "protocol: is 'all', expected one: doals"),
        (lambda: mosbench.score("nowhere", [np.ones(3)]), TypeError, "predictions: is list, .*mosbench.metrics"),
        (lambda: mosbench.iou([0.1, 0.9], [9, 251]), ValueError, "predicted: has type float64, .*scores > 0.5"),
        (lambda: mosbench.iou([9, 251], None), ValueError, "truth: is None, expected labels"),
    ],
)
def test_wrong_arguments_are_refused_in_a_line(call, error, message):
    with pytest.raises(error, match=f"^{message}") as raised:
        call()
    assert "\n" not in str(raised.value) and "0x" not in str(raised.value)


def test_poses_that_are_not_finite_are_named(wall):
    pose = np.eye(4)
    pose[1, 2] = np.nan
    with pytest.raises(ValueError, match=r"^pose\[1, 2\]: is nan, expected a finite number"):
        mosbench.MOS().push(wall, pose)


def test_masked_values_are_refused(wall):
    masked = np.ma.masked_greater(wall, 1.5)
    with pytest.raises(ValueError, match="^points: has masked values"):
        mosbench.MOS().push(masked, IDENTITY)
    with pytest.raises(ValueError, match="^predicted: has masked values"):
        mosbench.iou(np.ma.array([9, 251], mask=[True, False]), [9, 251])
    assert len(mosbench.MOS().push(np.ma.array(wall), IDENTITY)[0].labels) == 400


def test_a_config_is_a_mapping_that_can_be_copied():
    config = mosbench.Config.preset("best").replace(voxel_size_m=0.25)
    for other in (pickle.loads(pickle.dumps(config)), copy.deepcopy(config), copy.copy(config)):
        assert other == config and other is not config and other.method == "hmm-mos-plus"
    assert dict(config) == config.to_dict() and len(config) == len(config.to_dict())
    assert "voxel_size_m" in config and list(config) == list(config.to_dict())


def test_answers_are_true_when_they_are_good(street, finished, near, tmp_path):
    assert mosbench.compare(finished, finished)
    other = mosbench.run(street, config=near.replace(min_otsu_score=30), out=tmp_path / "other")
    worse = mosbench.compare(finished, other, even_if=True)
    assert isinstance(worse, mosbench.Comparison) and not worse
    assert mosbench.doctor(street)
    faulty = mosbench.doctor(tmp_path / "nowhere")
    assert isinstance(faulty, mosbench.Checkup) and not faulty and faulty.symptoms


def test_a_preset_stays_under_settings_by_name(street, tmp_path):
    plain = mosbench.run(street, preset="doals-20m", config={"min_otsu_score": 7}, out=tmp_path / "run")
    config = plain.header["settings"]
    assert config["min_otsu_score"] == 7 and config["max_range_m"] == 20.0 and plain.header["preset"] == "doals-20m"


def test_trajectories_are_named_and_not_their_files():
    poses = np.tile(IDENTITY, (3, 1, 1))
    with pytest.raises(ValueError, match="^estimate: holds 2 poses, expected 3 as in truth"):
        mosbench.evaluate_trajectory(poses[:2], poses)
    with pytest.raises(ValueError, match=r"^truth\[0\]: has another last row"):
        mosbench.evaluate_trajectory(poses, 2 * poses)
    assert "/tmp" not in str(mosbench.evaluate_trajectory(poses, poses))
