"""What results and data sets say of themselves."""

import shutil

import numpy as np
import pytest

import mosbench


@pytest.fixture(scope="module")
def sensors(tmp_path_factory) -> mosbench.Dataset:
    """Three scans of four sensors."""
    return mosbench.open(mosbench.simulate(tmp_path_factory.mktemp("data") / "four", layout="helimos", scans=3))


def theirs(street, items=None, poses=None):
    """Returns an object of a class of its own, as KISS-ICP takes data sets."""

    class Theirs:
        gt_poses = mosbench.open(street).gt_poses[:3] if poses is None else poses

        def __len__(self):
            return 3

        def __getitem__(self, index):
            return mosbench.open(street)[index] if items is None else items[index]

    return Theirs()


def test_strange_predictions_are_a_warning(street, finished, tmp_path):
    assert finished.warnings == [] and "WARNING" not in repr(finished)
    labels = tmp_path / "all" / "08" / "labels"
    labels.mkdir(parents=True)
    for scan in mosbench.open(street):
        np.full(len(scan.points), 251, "<u4").tofile(labels / f"{scan.stem}.label")
    scored = mosbench.score(street, tmp_path / "all", "semantickitti-mos")
    assert scored.warnings[0].startswith("08: 100.0 % of the points are predicted moving")
    assert "WARNING: 08: 100.0 %" in repr(scored) and "100.0 %" in scored._repr_html_()


def test_half_a_run_is_known(sensors, near, tmp_path):
    whole = mosbench.run(sensors, config=near, out=tmp_path / "run")
    assert len(whole) == 4 and not [text for text in whole.warnings if "INCOMPLETE" in text]
    shutil.rmtree(tmp_path / "run" / "Avia")
    half = mosbench.Result(tmp_path / "run")
    assert [text for text in half.warnings if text.startswith("INCOMPLETE") and "Avia" in text]
    assert "WARNING: INCOMPLETE" in repr(half)
    one = mosbench.Result(half[0].folder)
    assert not [text for text in one.warnings if "INCOMPLETE" in text]


def test_length_index_and_iteration_agree(sensors, street, finished):
    assert [one.name for one in sensors] == [sensors[i].name for i in range(len(sensors))]
    assert [sequence.name for sequence in finished] == ["08"] and len(finished) == 1
    assert finished[0] is finished["08"] and finished[-1] is finished[0]
    with pytest.raises(IndexError):
        finished[1]
    with pytest.raises(KeyError):
        finished["09"]
    sequence = mosbench.open(street)
    assert len(list(sequence)) == len(sequence)


def test_results_say_undefined_without_a_unit(street, near, tmp_path):
    result = mosbench.run(theirs(street), config=near, out=tmp_path / "run")
    assert result.iou is None and "IoU undefined, precision" in repr(result)


def test_a_report_is_html(finished, tmp_path):
    with pytest.raises(ValueError, match=r"^file: is .*x\.pdf, expected a name in \.html"):
        finished.report(tmp_path / "x.pdf")
    assert not list(tmp_path.iterdir())


def test_objects_of_two_classes_have_folders_of_their_own(street, near, tmp_path):
    class Others(type(theirs(street))):
        pass

    mosbench.run(theirs(street), config=near, out=tmp_path / "run")
    with pytest.raises(ValueError, match="has scans of .*Theirs, expected those of .*Others: give each an out"):
        mosbench.run(Others(), config=near, out=tmp_path / "run")
    assert len(mosbench.Result(tmp_path / "run")) == 1


def test_wrong_objects_are_named_and_leave_nothing(street, near, tmp_path):
    good = [mosbench.open(street)[index] for index in range(3)]
    for data, message in (
        (theirs(street, [good[0], "nonsense", good[2]]), "scan 1: is str without points"),
        (theirs(street, [list(good[0])]), "scan 0: has rows of different lengths"),
        (theirs(street, [good[0], good[1], ()]), "scan 2: is tuple without points"),
        (theirs(street, [(np.ma.masked_greater(points, 0), times) for points, times in good]), "scan 0: has masked"),
        (theirs(street, poses=np.tile(np.eye(4), (2, 1, 1))), "data: has 2 gt_poses for 3 scans"),
        (theirs(street, poses=np.full((3, 4, 4), np.nan)), r"gt_poses\[0\]: is not finite"),
    ):
        with pytest.raises(ValueError, match=f"^{message}"):
            mosbench.run(data, config=near, out=tmp_path / "run")
        assert not list(tmp_path.iterdir())
