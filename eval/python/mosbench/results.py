"""Results of runs and of scored predictions."""

from __future__ import annotations

import dataclasses
import html
import json
import os
import pathlib
from typing import Any, Optional, Union

import numpy as np

from mosbench import _mosbench
from mosbench.flags import plain_errors

_SCAN_TYPE = np.dtype(
    [
        ("sequence", object),
        ("stem", object),
        ("points", np.int64),
        ("moving", np.int64),
        ("judged", np.bool_),
        ("threshold", np.float64),
        ("labelled", np.bool_),
        ("tp", np.int64),
        ("fp", np.int64),
        ("fn", np.int64),
        ("tn", np.int64),
        ("iou", np.float64),
    ]
)


def _scan_row(sequence: str, scan: dict[str, Any]) -> tuple:
    counts = scan["counts"] or {"tp": 0, "fp": 0, "fn": 0, "tn": 0}
    union = counts["tp"] + counts["fp"] + counts["fn"]
    iou = counts["tp"] / union if union else np.nan
    threshold = np.nan if scan["threshold"] is None else scan["threshold"]
    return (
        sequence, scan["stem"], scan["points"], scan["moving"], scan["judged"], threshold,
        scan["counts"] is not None, counts["tp"], counts["fp"], counts["fn"], counts["tn"], iou,
    )  # fmt: skip


@dataclasses.dataclass(frozen=True)
class SequenceResult:
    """One sequence. Metrics are fractions as the protocol defines them, None where they are 0/0."""

    name: str
    folder: pathlib.Path
    metrics: dict[str, Optional[float]]
    method_ms_per_scan: Optional[float]
    scans: list[dict[str, Any]] = dataclasses.field(repr=False)

    @property
    def iou(self) -> Optional[float]:
        """Of moving points."""
        return self.metrics["iou"]

    @property
    def per_scan(self) -> np.ndarray:
        """Structured array, a row per scan: stem, points, moving, judged, threshold (NaN without one),
        labelled, tp, fp, fn, tn, iou (NaN where nothing moves)."""
        return np.array([_scan_row(self.name, scan) for scan in self.scans], dtype=_SCAN_TYPE)

    def labels(self, stem: str) -> np.ndarray:
        """uint32 (N,), as the run wrote them."""
        return np.fromfile(self.folder / "labels" / f"{stem}.label", dtype="<u4")


class Result:
    """What a folder of results says: `mosbench.Result("results/runs/x")`, or what `run` returns."""

    def __init__(self, folder: Union[str, os.PathLike]):
        """Raises OSError when the folder holds no results or those of several runs."""
        self.folder = pathlib.Path(folder)
        content = _mosbench.load_results(os.fspath(folder))
        #: what the first result.json says beside its scans: settings, versions, where the scans are
        self.header: dict[str, Any] = json.loads(content["header"])
        self.sequences = [SequenceResult(**one) for one in content["sequences"]]
        self.method: str = content["method"]  #: its title
        self.setting: str = content["setting"]  #: of the method, in words
        self.dataset: str = content["dataset"]
        self.protocol: str = content["protocol"]
        self.simulated: bool = content["simulated"]
        self.warnings: list[str] = content["warnings"]  #: to be said wherever the numbers are shown
        #: iou, precision, recall and f1, 0 to 1; None where 0/0
        self.metrics: dict[str, Optional[float]] = content["metrics"]

    @property
    def iou(self) -> Optional[float]:
        """Of moving points, 0 to 1, aggregated over sequences as the protocol says; None where 0/0."""
        return self.metrics["iou"]

    @property
    def precision(self) -> Optional[float]:
        """As iou."""
        return self.metrics["precision"]

    @property
    def recall(self) -> Optional[float]:
        """As iou."""
        return self.metrics["recall"]

    @property
    def f1(self) -> Optional[float]:
        """As iou."""
        return self.metrics["f1"]

    @property
    def per_scan(self) -> np.ndarray:
        """SequenceResult.per_scan of all sequences, one after the other."""
        return np.concatenate([sequence.per_scan for sequence in self.sequences])

    def __getitem__(self, name: str) -> SequenceResult:
        for sequence in self.sequences:
            if sequence.name == name:
                return sequence
        known = ", ".join(sequence.name for sequence in self.sequences)
        raise KeyError(f"{self.folder} has no sequence {name}, expected one of {known}")

    def to_pandas(self) -> Any:
        """Returns per_scan as a pandas.DataFrame."""
        import pandas

        return pandas.DataFrame.from_records(self.per_scan)

    def report(self, file: Union[str, os.PathLike], *, max_mb: Optional[float] = None) -> pathlib.Path:
        """Writes the report, one HTML file with the scans in 3-D, and returns its path."""
        arguments = ["report", os.fspath(self.folder), "-o", os.fspath(file)]
        if max_mb is not None:
            arguments += ["--max-mb", str(max_mb)]
        plain_errors(_mosbench.command, arguments, True)
        return pathlib.Path(file)

    def _rows(self) -> list[tuple[str, ...]]:
        def percent(value: Optional[float]) -> str:
            return "undefined" if value is None else f"{100 * value:.1f}"

        rows = [
            (one.name, str(len(one.scans)), *(percent(one.metrics[m]) for m in ("iou", "precision", "recall")))
            for one in self.sequences
        ]
        if len(rows) > 1:
            scans = str(sum(len(one.scans) for one in self.sequences))
            rows.append(("all", scans, percent(self.iou), percent(self.precision), percent(self.recall)))
        return rows

    def _title(self) -> str:
        setting = f" ({self.setting})" if self.setting else ""
        simulated = ", simulated data" if self.simulated else ""
        return f"{self.method}{setting}, protocol {self.protocol}{simulated}"

    def __repr__(self) -> str:
        lines = [f"{name}: IoU {iou} %, precision {precision} %, recall {recall} %"
                 for name, _, iou, precision, recall in self._rows()]  # fmt: skip
        return "\n".join([self._title(), *lines])

    def _repr_html_(self) -> str:
        def cells(tag: str, row: tuple[str, ...]) -> str:
            return "<tr>" + "".join(f"<{tag}>{html.escape(cell)}</{tag}>" for cell in row) + "</tr>"

        head = cells("th", ("sequence", "scans", "IoU %", "precision %", "recall %"))
        body = "".join(cells("td", row) for row in self._rows())
        return f"<table><caption>{html.escape(self._title())}</caption>{head}{body}</table>"
