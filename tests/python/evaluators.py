"""The arithmetic of each benchmark's own program, written again from its rule.

A twin takes sequences, lists of scans (truth, prediction, points), and returns the text that the program prints and
its counts tp, fp, fn.
"""

import numpy as np

NAN = float("nan")


def ids(labels):
    return labels & 0xFFFF


def counts(truth, predicted, counted):
    """tp, fp, fn of one scan; arrays of bool."""
    return np.array([np.sum(counted & a) for a in (truth & predicted, ~truth & predicted, truth & ~predicted)])


def total(per_scan):
    return sum(per_scan, np.zeros(3, dtype=np.int64))


def distance(points, number=np.float64):
    x, y, z = (points[:, i].astype(number) for i in range(3))
    return np.sqrt(x * x + y * y + z * z)


def learning_map(static, moving):
    table = np.zeros(65536, dtype=int)
    table[static], table[moving] = 1, 2
    return table


KITTI = learning_map([9, 10, 11, 13, 15, 16, 18, 20, 30, 31, 32, 40, 44, 48, 49, 50, 51, 52, 60, 70, 71, 72, 80, 81, 99],
                     range(251, 260))
SIPAILOU = learning_map([9], [251, 252])


def evaluate_mos(table, ignored, mean_of_sequences=False):
    """semantic-kitti-api: a matrix of predicted and true classes, whose ignored true classes are cleared."""

    def evaluate(sequences):
        ious, every = [], np.zeros((3, 3), dtype=np.int64)
        for scans in sequences if mean_of_sequences else [sum(sequences, [])]:
            matrix = np.zeros((3, 3), dtype=np.int64)
            for truth, predicted, _ in scans:
                np.add.at(matrix, (table[ids(predicted)], table[ids(truth)]), 1)
            matrix[:, ignored] = 0
            every += matrix
            tp, moving = matrix[2, 2], matrix[2].sum() + matrix[:, 2].sum()
            ious.append(tp / (moving - tp + 1e-15))
        tp = every[2, 2]
        return f"{np.mean(ious):.3f}", [tp, every[2].sum() - tp, every[:, 2].sum() - tp]

    return evaluate


def doals_hmm(sequences):
    """HMM-MOS: true points out of range stand still, predicted ones are kept. A mean of scans in percent."""
    rows = []
    for truth, predicted, points in sum(sequences, []):
        inside = (distance(points) >= 0.5) & (distance(points) <= 20)
        rows.append(counts((ids(truth) > 250) & inside, ids(predicted) > 250, True))
    return f"{np.mean([100 * tp / (tp + fp + fn) if tp + fp + fn else NAN for tp, fp, fn in rows]):.2f}", total(rows)


def dynablox(sequences):
    """Dynablox: points out of range are dropped. float32 written with six digits, 1 where nothing moves, then a mean."""
    rows = []
    for truth, predicted, points in sum(sequences, []):
        far = distance(points, np.float32)
        inside = (far >= np.float32(0.5)) & (far <= np.float32(20))
        rows.append(counts(ids(truth) > 250, ids(predicted) > 250, inside))
    written = [float(f"{np.float32(tp) / np.float32(tp + fp + fn):.6g}") if tp + fp + fn else 1.0 for tp, fp, fn in rows]
    return f"{np.mean(written) * 100:.1f}", total(rows)


def mapmos(last_ignored, nearest=0.0):
    """MapMOS: sums in float32, without a number unless something truly moves."""

    def evaluate(sequences):
        rows = []
        for truth, predicted, points in sum(sequences, []):
            counted = (ids(truth) > last_ignored) & (distance(points) >= nearest)
            rows.append(counts(ids(truth) > 250, ids(predicted) > 250, counted))
        tp, fp, fn = total(rows).astype(np.float32)
        return (f"{float(tp / (tp + fp + fn)) * 100:.3f}" if tp + fn else "nan"), total(rows)

    return evaluate


def moe(sequences):
    rows = [total([counts(ids(t) > 250, ids(p) > 250, True) for t, p, _ in scans]) for scans in sequences]
    return f"{np.mean([tp / (tp + fp + fn) if tp + fp + fn else NAN for tp, fp, fn in rows]):.3f}", total(rows)


def mdetector(first_moving=251, static_prediction=None, fewest=0):
    """M-detector's scorers of Waymo, of KITTI and Avia, of nuScenes: float32 per sequence."""

    def evaluate(sequences):
        rows = []
        for scans in sequences:
            per_scan = []
            for truth, predicted, _ in scans:
                t, p = ids(truth), ids(predicted)
                moves = (p >= 251) & (p < 65535)
                counted = (t < 251) | ((t >= first_moving) & (t < 65535))
                if static_prediction is not None:
                    counted &= moves | (p == static_prediction)
                if len(t) >= fewest:
                    per_scan.append(counts(t >= first_moving, moves, counted))
            rows.append(total(per_scan))
        ious = [np.float32(tp) / np.float32(tp + fp + fn) if tp + fp + fn else NAN for tp, fp, fn in rows]
        return f"{np.mean([float(iou) for iou in ious]):.6g}", total(rows)

    return evaluate


def scene_flow(within):
    """OpenSceneFlow's evaluate_leaderboard, of the ids that stand for its masks: a mean of scans."""

    def evaluate(sequences):
        rows = []
        for truth, predicted, points in sum(sequences, []):
            counted = ~np.isin(ids(truth), [0, 40, 99, 259]) & np.all(np.abs(points[:, :2]) <= within, axis=1)
            rows.append(counts(ids(truth) > 250, ids(predicted) > 250, counted))
        return f"{np.mean([tp / (tp + fp + fn + 1e-6) for tp, fp, fn in rows]):.6g}", total(rows)

    return evaluate


TWINS = {
    "doals-hmm": doals_hmm,
    "doals-dynablox": dynablox,
    "semantickitti-mos": evaluate_mos(KITTI, [0]),
    "sipailou": evaluate_mos(SIPAILOU, []),
    "helimos-all": evaluate_mos(KITTI, [0], mean_of_sequences=True),
    "helimos-test": evaluate_mos(KITTI, [0], mean_of_sequences=True),
    "mapmos": mapmos(1),
    "mapmos-apollo": mapmos(-1),
    "mapmos-kitti-tracking": mapmos(2),
    "mapmos-nuscenes": mapmos(1, nearest=3.0),
    "moe": moe,
    "mdetector": mdetector(),
    "mdetector-kitti": mdetector(static_prediction=9),
    "mdetector-nuscenes": mdetector(first_moving=1000, fewest=2),
    "sceneflow-dynamic": scene_flow(35.0),
    "sceneflow-dynamic-far": scene_flow(np.inf),
}
