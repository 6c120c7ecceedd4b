"""Average precision of confidences, as scikit-learn defines it, on random scans of one sequence each."""

import json
import os
import pathlib
import subprocess

import numpy as np
import pytest

PROGRAM = pathlib.Path(os.environ["MOSBENCH_BINARY_DIR"]) / "eval" / "mosbench"
CASES = 200


def average_precision(moves, confidences):
    """sum of (recall[i] - recall[i - 1]) * precision[i] over all thresholds, without interpolation."""
    at = np.unique(confidences)[::-1]
    taken = confidences[None, :] >= at[:, None]
    tp, all_taken = (taken & moves).sum(axis=1), taken.sum(axis=1)
    recall = tp / moves.sum()
    return np.sum(np.diff(recall, prepend=0.0) * tp / all_taken), tp, all_taken, at


def written(folder, random, kind):
    """A sequence of one scan; returns which points move and how sure the method is."""
    count = int(random.integers(2, 60))
    moves = random.random(count) < 0.3
    moves[0] = True
    confidences = random.random(count)
    if kind == "few":
        confidences = np.round(confidences * 3) / 4
    confidences = confidences.astype({"few": "<f4"}.get(kind, kind))
    sequence, predictions = folder / "data/sequences/00", folder / "labels/sequences/00/predictions"
    for place in (sequence / "velodyne", sequence / "labels", predictions):
        place.mkdir(parents=True)
    (sequence / "poses.txt").write_text("1 0 0 0 0 1 0 0 0 0 1 0\n")
    (sequence / "calib.txt").write_text("Tr: 1 0 0 0 0 1 0 0 0 0 1 0\n")
    random.uniform(-9, 9, (count, 4)).astype(np.float32).tofile(sequence / "velodyne/000000.bin")
    np.where(moves, 251, 9).astype(np.uint32).tofile(sequence / "labels/000000.label")
    np.save(predictions / "000000.npy", confidences)
    return moves, confidences.astype(np.float64)


def scored(folder, *flags):
    words = [PROGRAM, "score", folder / "data", "--dataset", "semantickitti", "--predictions", folder / "labels", *flags]
    answer = subprocess.run(words, capture_output=True, text=True)
    assert answer.returncode == 0, answer.stderr
    return answer.stdout


@pytest.mark.parametrize("kind", ["few", "<f2", "<f4", "<f8"])
def test_average_precision_is_that_of_scikit_learn(kind, tmp_path):
    try:
        from sklearn.metrics import average_precision_score
    except ImportError:
        average_precision_score = None
    for case in range(CASES // 4):
        random = np.random.default_rng([case, len(kind), ord(kind[-1])])
        moves, confidences = written(tmp_path / str(case), random, kind)
        found = json.loads(scored(tmp_path / str(case), "--json"))["confidences"]
        expected, tp, taken, at = average_precision(moves, confidences)
        if average_precision_score is not None:
            assert expected == pytest.approx(average_precision_score(moves, confidences), abs=1e-12)
        assert found["average_precision"] == pytest.approx(expected, abs=1e-12)
        iou = tp / (taken + moves.sum() - tp)
        assert found["best"]["iou"] == iou.max() and found["best"]["threshold"] == at[iou.argmax()]
        own = confidences > 0.5
        assert found["labels"]["iou"] == (own & moves).sum() / (own | moves).sum()


def test_the_table_says_that_the_best_threshold_is_optimistic(tmp_path):
    written(tmp_path, np.random.default_rng(1), "<f4")
    text = scored(tmp_path)
    assert "average precision" in text and "own threshold: IoU" in text
    assert "(best on the same data: optimistic)" in text
