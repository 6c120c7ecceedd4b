"""Scores of arrays of labels."""

from __future__ import annotations

from typing import Any, Iterable, Mapping, Optional, Union

import numpy as np

from mosbench import _mosbench
from mosbench.arrays import Array, as_array


def _label_array(values: Any, name: str) -> Array:
    if values is None:
        raise ValueError(f"{name}: is None, expected labels (N,); a scan without truth has no score")
    labels = as_array(values, name)
    if labels.dtype.kind not in "biu":
        raise ValueError(f"{name}: has type {labels.dtype}, expected bool, or label ids as integers; of scores "
                         "say which move, as in scores > 0.5")
    if labels.dtype != bool and labels.size and 0 < labels.max() <= 2 and labels.min() >= 0:
        raise ValueError(f"{name}: holds no other ids than 0, 1 and 2, which are classes of a network; "
                         "expected bool, or label ids")
    return labels


def _counted_arrays(predicted: Any, truth: Any, points: Any) -> tuple[Array, Array, Optional[Array]]:
    return (
        _label_array(predicted, "predicted"),
        _label_array(truth, "truth"),
        None if points is None else as_array(points, "points"),
    )


def confusion(
    predicted: Any, truth: Any, protocol: str = "semantickitti-mos", points: Any = None
) -> dict[str, int]:
    """Returns the counts tp, fp, fn, tn, ignored and unknown_ids of one scan.

    predicted, truth: label ids (N,) as the protocol knows them, or bool (N,), true for moving.
    points: (N, 3) or (N, 4), needed by protocols that limit the range.
    """
    predicted, truth, points = _counted_arrays(predicted, truth, points)
    return _mosbench.count(predicted, truth, protocol, points)


def metrics(
    predicted: Any, truth: Any, protocol: str = "semantickitti-mos", points: Any = None
) -> dict[str, Optional[float]]:
    """Returns iou, precision, recall and f1 of moving points, 0 to 1; None where they are 0/0.

    predicted, truth, points: as of `confusion`.
    """
    predicted, truth, points = _counted_arrays(predicted, truth, points)
    return _mosbench.metrics(predicted, truth, protocol, points)


def iou(
    predicted: Any, truth: Any, protocol: str = "semantickitti-mos", points: Any = None
) -> Optional[float]:
    """Returns the IoU of moving points, 0 to 1; None when nothing moves in either.

    predicted, truth, points: as of `confusion`.
    """
    return metrics(predicted, truth, protocol, points)["iou"]


def pooled(
    scans: Iterable[Union[Mapping[str, int], Iterable[Mapping[str, int]]]], protocol: str = "semantickitti-mos"
) -> dict[str, Optional[float]]:
    """Returns iou, precision, recall and f1 of many scans as `mosbench score` gives them, 0 to 1; None where 0/0.

    scans: what `confusion` returned for each scan of a sequence, or an iterable of such for each of several
    sequences. Most protocols add the counts up; those that average say so in `mosbench list protocols`.
    """
    items: list[Any] = list(scans)
    if not items:
        raise ValueError("scans: is empty, expected counts of at least one scan")
    of_one = isinstance(items[0], Mapping)
    return _mosbench.pooled([items] if of_one else [list(one) for one in items], protocol)


def mean_of_scans(scans: Iterable[Mapping[str, int]]) -> Optional[float]:
    """Returns the mean IoU of single scans, where a scan of few moving points counts as much as one of many.

    scans: as of `pooled`. Scans where nothing moves in truth or prediction are left out; None where no scan is left.
    """
    unions = [(one["tp"], one["tp"] + one["fp"] + one["fn"]) for one in scans]
    ious = [tp / union for tp, union in unions if union]
    return float(np.mean(ious)) if ious else None
