"""Poses in arrays and files of them."""

import numpy as np
import pytest

import mosbench


@pytest.fixture(scope="module")
def own(street) -> np.ndarray:
    """The poses of the street, which are no identities; its calib.txt holds a Tr."""
    poses = mosbench.open(street).gt_poses
    assert np.abs(poses[-1] - poses[0]).max() > 0.1
    return poses


def test_written_poses_are_read_as_the_lidars(street, own, tmp_path):
    mosbench.write_poses(tmp_path / "poses.txt", list(own))
    assert np.array_equal(mosbench.open(street, poses=tmp_path / "poses.txt").gt_poses, own)
    assert (tmp_path / "poses.txt.frame").read_text().startswith("lidar ")
    stamps = [scan.stamp_ns for scan in mosbench.open(street)]
    mosbench.write_poses(tmp_path / "poses.tum", own, format="tum", stamps=stamps)
    assert np.allclose(mosbench.open(street, poses=tmp_path / "poses.tum").gt_poses, own, atol=1e-12)


def test_wrong_poses_are_refused(own, tmp_path):
    file = tmp_path / "poses.txt"
    nan, sheared = own.copy(), own.copy()
    nan[2, 0, 0], sheared[1, 0, 0] = np.nan, 3
    for poses, message in (
        (own[0], r"has shape \(4, 4\), expected \(K, 4, 4\)"),
        (nan, r"poses\[2\]: is not finite"),
        (sheared, r"poses\[1\]: is not rigid"),
        (["a"], "are no numbers"),
        (5, r"has shape \(\), expected \(K, 4, 4\)"),
        ([own[0], own[0][:3]], "has rows of different lengths"),
    ):
        with pytest.raises(ValueError, match=message):
            mosbench.write_poses(file, poses)
    with pytest.raises(ValueError, match="expected 'kitti' or 'tum'"):
        mosbench.write_poses(file, own, format="dynablox")
    with pytest.raises(ValueError, match="stamps: are not given"):
        mosbench.write_poses(file, own, format="tum")
    with pytest.raises(ValueError, match="stamps: are 1, expected 12"):
        mosbench.write_poses(file, own, format="tum", stamps=[1])
    with pytest.raises(ValueError, match=r"stamps\[1\]: is 7, expected a later one than 7"):
        mosbench.write_poses(file, own, format="tum", stamps=[7] * 12)
    assert not list(tmp_path.iterdir())


def test_poses_may_be_arrays_wherever_data_are_read(street, near, own, finished, tmp_path):
    moved = own.copy()
    moved[:, 0, 3] += 100
    opened = mosbench.open(street, poses=list(moved))
    assert np.array_equal(opened.gt_poses, moved)
    assert mosbench.doctor(opened) and mosbench.doctor(street, poses=moved)
    result = mosbench.run(opened, config=near, out=tmp_path / "run")
    assert not [text for text in result.warnings if "POSES" in text]
    assert result.header["reading"]["pose_frame"].startswith("lidar")
    before = (result["08"].folder / "result.json").stat().st_mtime_ns
    again = mosbench.run(street, config=near, poses=moved, out=tmp_path / "run")
    assert (again["08"].folder / "result.json").stat().st_mtime_ns == before
    assert mosbench.score(opened, finished, "semantickitti-mos").metrics == finished.metrics
    with pytest.raises(ValueError, match="^poses: 3 pose rows for 12 scans"):
        mosbench.open(street, poses=own[:3])
    with pytest.raises(ValueError, match="^out: is not given"):
        mosbench.run(street, poses=own)


def test_a_run_without_poses_says_what_to_type(street, near, tmp_path):
    for call in (
        lambda: mosbench.run(street, poses=False, out=tmp_path / "run"),
        lambda: mosbench.run(mosbench.open(street, poses=False), out=tmp_path / "run"),
        lambda: mosbench.doctor(mosbench.open(street, poses=False)),
    ):
        with pytest.raises(ValueError, match="^poses: is False.*odometry='simple'"):
            call()
    assert not list(tmp_path.iterdir())
    result = mosbench.run(mosbench.open(street, poses=False), config=near, odometry="simple", out=tmp_path / "run")
    assert result.header["reading"]["pose_odometry"]


def test_doubtful_poses_are_a_warning_of_the_result(street, near, own, tmp_path):
    np.savetxt(tmp_path / "poses.txt", own[:, :3].reshape(-1, 12))
    result = mosbench.run(street, config=near, poses=tmp_path / "poses.txt", out=tmp_path / "run")
    loud = [text for text in result.warnings if text.startswith("08: THE POSES FIT AS THOSE OF THE LIDAR")]
    assert len(loud) == 1 and f"WARNING: {loud[0]}" in repr(result) and loud[0] in result.remarks
    assert "THE POSES FIT" in mosbench.Result(result.folder)._repr_html_()


def test_poses_are_refined_or_static_by_keywords(street, own, near, tmp_path):
    drifting = own.copy()
    drifting[:, :3, 3] += 0.04 * np.arange(len(own))[:, None] * own[0, :3, 0]
    refined = mosbench.open(street, poses=drifting, refine_poses=True).gt_poses
    assert np.array_equal(refined[0], drifting[0])
    off = [np.abs(poses[-1, :3, 3] - own[-1, :3, 3]).max() for poses in (drifting, refined)]
    assert off[1] < 0.5 * off[0]
    result = mosbench.run(street, poses="static", config=near, out=tmp_path / "run")
    assert result.header["reading"]["poses"] == "static"
    assert np.array_equal(mosbench.open(street, poses="static").gt_poses[-1], np.eye(4))
