"""Every protocol against the arithmetic of its benchmark's program, on seeded sets of all edges."""

import json
import os
import pathlib
import subprocess

import numpy as np
import pytest
from evaluators import TWINS

PROGRAM = pathlib.Path(os.environ["MOSBENCH_BINARY_DIR"]) / "eval" / "mosbench"
STILL = [0, 1, 2, 9, 10, 40, 48, 99, 250]
OTHERS = [*range(250, 261), 300, 358, 359, 400, 999, 1000, 1001, 65534, 65535]
#: Not what would make a label look like a float32, which the program refuses.
INSTANCES = [0, 1, 500, 9999, 30000, 65535]
LIMITS_M = [0.5, 3.0, 20.0, 35.0]
CASES = ["plain", "no motion in truth", "no motion predicted", "no motion", "unlabelled", "limits", "empty scans"]


def scan_of(case, random):
    count = int(random.integers(0, 3)) if case == "empty scans" else int(random.integers(1, 80))
    draw = lambda moving: random.choice(STILL + OTHERS if moving else STILL, count).astype(np.uint32)  # noqa: E731
    truth = draw(case not in ("no motion in truth", "no motion")) * (case != "unlabelled")
    predicted = draw(case not in ("no motion predicted", "no motion"))
    points = random.uniform(-40, 40, (count, 4)).astype(np.float32)
    if case == "limits":
        at = random.choice(LIMITS_M, count).astype(np.float32)
        at = np.choose(random.integers(0, 3, count), [at, np.nextafter(at, np.float32(0)), np.nextafter(at, np.float32(99))])
        points[:] = 0
        points[np.arange(count), random.integers(0, 3, count)] = at * random.choice([-1, 1], count)
    instances = [random.choice(INSTANCES, count).astype(np.uint32) << 16 for _ in range(2)]
    return truth | instances[0], predicted | instances[1], points


def drawn(case, seed):
    random = np.random.default_rng([seed, CASES.index(case)])
    return [[scan_of(case, random) for _ in range(4)] for _ in range(2)]


def write(folder, sequences):
    for s, scans in enumerate(sequences):
        sequence = folder / "data" / "sequences" / f"{s:02}"
        labels = folder / "labels" / "sequences" / f"{s:02}" / "predictions"
        for place in (sequence / "velodyne", sequence / "labels", labels):
            place.mkdir(parents=True)
        (sequence / "poses.txt").write_text("1 0 0 0 0 1 0 0 0 0 1 0\n" * len(scans))
        (sequence / "calib.txt").write_text("Tr: 1 0 0 0 0 1 0 0 0 0 1 0\n")
        for k, (truth, predicted, points) in enumerate(scans):
            points.tofile(sequence / "velodyne" / f"{k:06}.bin")
            truth.tofile(sequence / "labels" / f"{k:06}.label")
            predicted.tofile(labels / f"{k:06}.label")
    return folder


def score(folder, *flags):
    words = [PROGRAM, "score", folder / "data", "--dataset", "semantickitti", "--predictions", folder / "labels"]
    return subprocess.run([*words, "--protocol", "all", "--id-map", ID_MAP, "--json", *flags], capture_output=True, text=True)


#: Every id as it is: else ids up to 2 alone are taken for a network's classes.
ID_MAP = ",".join(f"{i}:{i}" for i in sorted({*STILL, *OTHERS}))


def expect_equal(answer, sequences):
    assert answer.returncode == 0, answer.stderr
    rows = {row["name"]: row for row in json.loads(answer.stdout)["protocols"]}
    assert rows.keys() == TWINS.keys()
    for name, twin in TWINS.items():
        with np.errstate(invalid="ignore"):
            text, (tp, fp, fn) = twin(sequences)
        assert (name, rows[name]["tp"], rows[name]["fp"], rows[name]["fn"]) == (name, tp, fp, fn)
        assert (name, rows[name]["published_text"]) == (name, text)


@pytest.mark.parametrize("case", CASES)
def test_protocols_equal_their_programs(case, tmp_path):
    for seed in range(6):
        sequences = drawn(case, seed)
        expect_equal(score(write(tmp_path / str(seed), sequences)), sequences)


def test_missing_and_extra_scans_are_refused_or_left_out(tmp_path):
    sequences = drawn("plain", 9)
    folder = write(tmp_path, sequences)
    predictions = folder / "labels" / "sequences" / "00" / "predictions"
    (predictions / "000002.label").unlink()
    assert score(folder).returncode == 3
    del sequences[0][2]
    expect_equal(score(folder, "--allow-missing"), sequences)
    (predictions / "000009.label").write_bytes(b"\0" * 4)
    answer = score(folder)
    assert answer.returncode == 3 and "000009.label" in answer.stderr
    expect_equal(score(folder, "--allow-missing"), sequences)
