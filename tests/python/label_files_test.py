"""Labels as people write them with NumPy beside their scans: each type, either order, packed or not."""

import os
import pathlib
import subprocess

import numpy as np
import pytest

PROGRAM = pathlib.Path(os.environ["MOSBENCH_BINARY_DIR"]) / "eval" / "mosbench"
IDS = np.array([9, 251, 0, 40, 252])


def recording(folder):
    (folder / "velodyne").mkdir(parents=True)
    (folder / "labels").mkdir()
    (folder / "poses.txt").write_text("1 0 0 0 0 1 0 0 0 0 1 0\n")
    np.random.default_rng(5).uniform(-9, 9, (len(IDS), 4)).astype(np.float32).tofile(folder / "velodyne/000000.bin")
    return folder / "labels"


def truth(folder):
    """The labels as `convert` writes them once they are read."""
    words = [PROGRAM, "convert", folder, "--layout", "semantickitti", "--out", folder.with_suffix(".out")]
    answer = subprocess.run(words, capture_output=True, text=True)
    assert answer.returncode == 0, answer.stderr
    [file] = folder.with_suffix(".out").rglob("000000.label")
    return np.fromfile(file, np.uint32)


@pytest.mark.parametrize("kind", ["|u1", "<u2", ">u2", "<i4", ">i8", "<u8", "<f4", ">f8"])
@pytest.mark.parametrize("save", ["npy", "npz", "npz packed", "npz of two", "fortran"])
def test_labels_are_read(kind, save, tmp_path):
    labels = recording(tmp_path / "drive")
    ids = IDS.astype(kind)
    if save == "npz":
        np.savez(labels / "000000.npz", ids)
    elif save == "npz packed":
        np.savez_compressed(labels / "000000.npz", ids)
    elif save == "npz of two":
        np.savez_compressed(labels / "000000.npz", points=np.zeros((len(IDS), 3)), labels=ids)
    else:
        np.save(labels / "000000.npy", np.asfortranarray(ids.reshape(-1, 1)) if save == "fortran" else ids)
    np.testing.assert_array_equal(truth(tmp_path / "drive"), IDS)


def test_archives_that_say_nothing_are_refused(tmp_path):
    labels = recording(tmp_path / "drive")
    np.savez(labels / "000000.npz", a=IDS, b=IDS)
    answer = subprocess.run([PROGRAM, "convert", tmp_path / "drive", "--layout", "semantickitti", "--out", tmp_path / "o"],
                            capture_output=True, text=True)
    assert answer.returncode == 3
    assert "000000.npz: holds the arrays a.npy, b.npy, expected one array, or one of the name labels" in answer.stderr
