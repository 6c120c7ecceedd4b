"""Results of runs and of scored predictions."""

from __future__ import annotations

import dataclasses
import html
import json
import os
import pathlib
from typing import Any, Iterator, Optional, Union

import numpy as np

from mosbench import _mosbench
from mosbench.arrays import Array
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


def _scan_row(sequence: str, scan: dict[str, Any]) -> tuple[Any, ...]:
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
    """One sequence of a Result.

    name: of the sequence. folder: of its result.json and labels. header: what its result.json says beside its
    scans, in the present format (`settings`, `reading`, `provenance`, ...). metrics: iou, precision, recall and f1 as
    fractions, as the protocol defines them, None where 0/0.
    method_ms_per_scan: wall time of the method. warnings: what makes its numbers doubtful. scans: what the result says of each scan.
    """

    name: str
    folder: pathlib.Path
    header: dict[str, Any] = dataclasses.field(repr=False)
    metrics: dict[str, Optional[float]]
    method_ms_per_scan: Optional[float]
    warnings: list[str] = dataclasses.field(repr=False)
    scans: list[dict[str, Any]] = dataclasses.field(repr=False)

    @property
    def iou(self) -> Optional[float]:
        """Of moving points."""
        return self.metrics["iou"]

    @property
    def per_scan(self) -> Array:
        """Structured array, a row per scan: stem, points, moving, judged, threshold (NaN without one),
        labelled, tp, fp, fn, tn, iou (NaN where nothing moves)."""
        return np.array([_scan_row(self.name, scan) for scan in self.scans], dtype=_SCAN_TYPE)

    @property
    def remarks(self) -> list[str]:
        """What was assumed of the data and of the predictions, and the warnings."""
        of_predictions = self.header.get("predictions", {}).get("remarks", [])
        return [*self.header.get("remarks", []), *of_predictions, *self.warnings]

    def labels(self, stem: str) -> Array:
        """uint32 (N,), as the run wrote them."""
        return np.fromfile(self.folder / "labels" / f"{stem}.label", dtype="<u4")


def _without_results(folder: pathlib.Path, sequences: list[SequenceResult]) -> list[str]:
    """Returns the sequences of a run, as each of its results names them, that have no result in its folder."""
    wanted: dict[str, None] = {}
    for sequence in sequences:
        file = sequence.folder / "result.json"
        if sequence.folder == folder or not file.is_file():
            return []  # one result of a run was asked for, and not the run
        content = json.loads(file.read_bytes())
        wanted.update(dict.fromkeys(content.get("places", content.get("timing", {})).get("sequences_of_run", [])))
    return [name for name in wanted if name not in {sequence.name for sequence in sequences}]


class Result:
    """What a folder of results says: `mosbench.Result("results/runs/x")`, or what `run` and `score` return.

    `len`, iteration and `result[i]` are of its sequences, `result["08"]` is one of them.

    folder: where it lies. sequences: a SequenceResult each. header: that of the first sequence, with settings,
    versions and how the data were read. method: its title; setting: of the method, in words. dataset: its layout.
    protocol: by which it is scored. simulated: whether the data are. metrics: iou, precision, recall and f1 over
    all sequences, 0 to 1, None where 0/0. warnings: what has to be said wherever the numbers are shown.
    """

    def __init__(self, folder: Union[str, os.PathLike[str]]):
        """Raises OSError when the folder holds no results or those of several runs."""
        self.folder = pathlib.Path(folder)
        content = plain_errors(_mosbench.load_results, os.fspath(folder))
        self.sequences = [
            SequenceResult(**{**one, "header": json.loads(one["header"])}) for one in content["sequences"]
        ]
        self.header: dict[str, Any] = self.sequences[0].header
        self.method: str = content["method"]
        self.setting: str = content["setting"]
        self.dataset: str = content["dataset"]
        self.protocol: str = content["protocol"]
        self.simulated: bool = content["simulated"]
        self.warnings: list[str] = self._own_warnings() + content["warnings"]
        self.metrics: dict[str, Optional[float]] = content["metrics"]

    def _own_warnings(self) -> list[str]:
        missing = _without_results(self.folder, self.sequences)
        return [f"INCOMPLETE: the run is interrupted, {', '.join(missing)} have no results"] if missing else []

    @property
    def remarks(self) -> list[str]:
        """What was assumed or found odd in each sequence, warnings among them."""
        return [f"{one.name}: {remark}" for one in self.sequences for remark in one.remarks]

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
    def per_scan(self) -> Array:
        """SequenceResult.per_scan of all sequences, one after the other."""
        return np.concatenate([sequence.per_scan for sequence in self.sequences])

    def __len__(self) -> int:
        return len(self.sequences)

    def __iter__(self) -> Iterator[SequenceResult]:
        return iter(self.sequences)

    def __getitem__(self, name: Union[str, int]) -> SequenceResult:
        if isinstance(name, (int, np.integer)):
            return self.sequences[name]
        for sequence in self.sequences:
            if sequence.name == name:
                return sequence
        known = ", ".join(sequence.name for sequence in self.sequences)
        raise KeyError(f"{self.folder} has no sequence {name}, expected one of {known}")

    def to_pandas(self) -> Any:
        """Returns per_scan as a pandas.DataFrame."""
        import pandas

        return pandas.DataFrame.from_records(self.per_scan)

    def report(self, file: Union[str, os.PathLike[str]], *, max_mb: Optional[float] = None) -> pathlib.Path:
        """Writes the report, one .html file with the scans in 3-D, and returns its path.

        Raises ValueError for another kind of file, OSError.
        """
        if pathlib.Path(file).suffix not in (".html", ".htm"):
            raise ValueError(f"file: is {os.fspath(file)}, expected a name in .html")
        arguments = ["report", os.fspath(self.folder), "-o", os.fspath(file)]
        if max_mb is not None:
            arguments += ["--max-mb", str(max_mb)]
        plain_errors(_mosbench.command, arguments, True)
        return pathlib.Path(file)

    def _rows(self) -> list[tuple[str, ...]]:
        def percent(value: Optional[float]) -> str:
            return "undefined" if value is None else f"{100 * value:.1f} %"

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
        lines = [f"{name}: IoU {iou}, precision {precision}, recall {recall}"
                 for name, _, iou, precision, recall in self._rows()]  # fmt: skip
        return "\n".join([self._title(), *lines, *(f"WARNING: {warning}" for warning in self.warnings)])

    def _repr_html_(self) -> str:
        def cells(tag: str, row: tuple[str, ...]) -> str:
            return "<tr>" + "".join(f"<{tag}>{html.escape(cell)}</{tag}>" for cell in row) + "</tr>"

        head = cells("th", ("sequence", "scans", "IoU", "precision", "recall"))
        body = "".join(cells("td", row) for row in self._rows())
        warnings = "".join(f"<p>WARNING: {html.escape(warning)}</p>" for warning in self.warnings)
        return f"<table><caption>{html.escape(self._title())}</caption>{head}{body}</table>{warnings}"
