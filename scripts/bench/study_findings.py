#!/usr/bin/env python3
"""Says in numbers how much of each disturbance a method stands, and draws the curves of a computed study.

Takes the study's file and the folder of its results. Prints what `mosbench rank JOB.yaml` says, then in Markdown the
strength that costs 10 points of IoU, or half of it, read off the curve of means with straight lines between strengths;
a method that never loses so much gets the strongest with ">". Last comes the paired change at the strongest.
"""

import argparse
import csv
import html
import json
import pathlib
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
COLOURS = ["#0072B2", "#E8590C", "#00805E", "#A8478A", "#8A6D00", "#4A5360", "#7A3B1D", "#5B2FB0"]
DASHES = ["", "7 3", "2 3", "10 3 2 3", "5 5", "12 4", "4 2", "1 3"]  # as the page of a study
# Student's t at 97.5 % by degrees of freedom, from one on.
STUDENT = [12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.160, 2.145, 2.131]
NOT_FROM_ZERO = ("beams", "every_nth_scan")  # whose scans are whole at another number than 0


def printed_table(chosen, form):
    """What `mosbench rank JOB.yaml` prints, also where cells are missing."""
    done = subprocess.run([chosen.program, "rank", chosen.study, "--out", chosen.out, "--as", form],
                          capture_output=True, text=True, check=False)
    if done.returncode > 1:
        sys.exit(f"study_findings.py: {done.stderr.strip()}")
    return done.stdout


def cells_of(chosen):
    """IoU by (method, axis, value), then by sequence: the mean of its seeds; None where one is undefined."""
    cells = {}
    for cell in csv.DictReader(printed_table(chosen, "csv").splitlines()):
        label = f"{cell['method']} ({cell['odometry']})" if cell["odometry"] else cell["method"]
        by_sequence = cells.setdefault((label, cell["axis"], cell["value"]), {})
        by_sequence.setdefault((cell["group"], cell["sequence"]), []).append(float(cell["iou"]) if cell["iou"] else None)
    return {key: {name: None if None in seeds else statistics.mean(seeds) for name, seeds in by_sequence.items()}
            for key, by_sequence in cells.items()}


def paired_change(cells, label, axis, value):
    """Mean change of IoU against the undisturbed cells of the same sequences, with half of its 95 % interval."""
    before, now = cells.get((label, "", ""), {}), cells.get((label, axis, value), {})
    changes = [100 * (now[name] - before[name]) for name in now if None not in (now[name], before.get(name))]
    if not changes:
        return "-"
    if not 3 <= len(changes) <= len(STUDENT) + 1:
        return f"{statistics.mean(changes):+.1f}"
    half = STUDENT[len(changes) - 2] * statistics.stdev(changes) / len(changes) ** 0.5
    return f"{statistics.mean(changes):+.1f} ± {half:.1f}"


def ious(line):
    return [point["iou"]["value"] for point in line["points"]]


def strength_text(curve, line, goal):
    """Where the curve first falls to `goal` of its first value."""
    places, values = [0.0, *map(float, curve["values"][1:])], ious(line)
    if not values[0] or None in values:  # not known, or nothing to lose
        return "-"
    for i in range(1, len(values)):
        if values[i] <= goal(values[0]):
            share = (values[i - 1] - goal(values[0])) / (values[i - 1] - values[i])
            return f"{places[i - 1] + share * (places[i] - places[i - 1]):.2g}"
    return f"> {places[-1]:g}"


def by_method(found, curves, title, text):
    """A row per method, a column per curve."""
    rows = [[title, *(curve["axis"] for curve in curves)], ["---"] * (len(curves) + 1)]
    for i, row in enumerate(found["rows"]):
        rows.append([f"`{row['label']}`", *(text(curve, curve["lines"][i]) for curve in curves)])
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def text_of(found, cells, table):
    said = "\n".join(line for line in table.splitlines() if not line.startswith("results in "))
    parts = [f"Computed by version {found['version']}.", f"```\n{said}\n```"]
    disturbed = [curve for curve in found["curves"] if curve["unit"]]  # settings have none
    graded = [curve for curve in disturbed if curve["axis"] not in NOT_FROM_ZERO]
    if disturbed:
        parts += [by_method(found, graded, "strength that costs 10 points",
                            lambda curve, line: strength_text(curve, line, lambda iou: iou - 0.1)),
                  by_method(found, graded, "strength that halves the IoU",
                            lambda curve, line: strength_text(curve, line, lambda iou: iou / 2)),
                  by_method(found, disturbed, "change of IoU in points at the strongest, ± half of the paired 95 % interval",
                            lambda curve, line: paired_change(cells, line["label"], curve["axis"], curve["values"][-1]))]
    return "\n\n".join(parts)


def panel(left, top, curve):
    """IoU over the values of a curve, 240 x 190, each value at the same distance; a setting's default stands apart."""
    x_of = lambda i: left + 44 + 184 * i / max(1, len(curve["values"]) - 1)
    y_of = lambda iou: top + 150 - 120 * iou
    title = html.escape(curve["axis"] + (f", {curve['unit']}" if curve["unit"] not in ("", "1") else ""))
    parts = [f'<text x="{left + 136}" y="{top + 18}" class="title">{title}</text>']
    parts += [f'<path d="M{left + 44} {y_of(tick):.1f}h184" stroke="#ddd"/><text x="{left + 38}" y="{y_of(tick) + 4:.1f}" '
              f'class="tick">{100 * tick:.0f}</text>' for tick in (0, 0.25, 0.5, 0.75, 1)]
    parts += [f'<text x="{x_of(i):.1f}" y="{top + 168}">{html.escape(value)}</text>' for i, value in enumerate(curve["values"])]
    first = 0 if curve["unit"] else 1
    for i, line in enumerate(curve["lines"]):
        points = [f"{x_of(k):.1f},{y_of(iou):.1f}" for k, iou in enumerate(ious(line)) if iou is not None and k >= first]
        parts.append(f'<polyline points="{" ".join(points)}" {stroke(i)}/>')
        if first and ious(line)[0] is not None:
            parts.append(f'<circle cx="{x_of(0):.1f}" cy="{y_of(ious(line)[0]):.1f}" r="3" fill="{COLOURS[i % 8]}"/>')
    return "".join(parts)


def stroke(i):
    return f'stroke="{COLOURS[i % 8]}"' + (f' stroke-dasharray="{DASHES[i % 8]}"' if DASHES[i % 8] else "")


def plot(found):
    """All curves in rows of four, and what the lines are."""
    panels = [panel(240 * (i % 4), 190 * (i // 4), curve) for i, curve in enumerate(found["curves"])]
    place = len(panels)
    left, top = 240 * (place % 4) + 40, 190 * (place // 4) + 32
    for i, row in enumerate(found["rows"]):
        panels.append(f'<path d="M{left} {top + 18 * i - 4}h34" fill="none" stroke-width="2" {stroke(i)}/>'
                      f'<text x="{left + 42}" y="{top + 18 * i}" class="legend">{html.escape(row["label"])}</text>')
    width, height = 240 * min(4, place + 1), 190 * (place // 4 + 1)
    kind = "simulated, " if found["simulated"] else ""
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="11">'
            '<style>text{text-anchor:middle;fill:#444}.title{font-weight:bold}.tick{text-anchor:end}'
            '.legend{text-anchor:start}polyline{fill:none;stroke-width:2}</style>'
            f'<title>{html.escape(found["name"])}: {kind}IoU in per cent</title>'
            f'<rect width="{width}" height="{height}" fill="#fff"/>' + "\n".join(panels) + "</svg>\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("study", type=pathlib.Path, help="the study's YAML file")
    parser.add_argument("out", type=pathlib.Path, help="folder of its results, as of `mosbench run JOB.yaml --out`")
    parser.add_argument("--program", default=str(ROOT / "build/release/eval/mosbench"))
    parser.add_argument("--svg", type=pathlib.Path, help="file for the curves")
    chosen = parser.parse_args()
    found = json.loads(printed_table(chosen, "json"))
    if found["done"] < found["cells"]:
        sys.exit(f"study_findings.py: {found['done']} of {found['cells']} cells of {chosen.study} are done in {chosen.out}, "
                 "expected all: mosbench run")
    print(text_of(found, cells_of(chosen), printed_table(chosen, "text")))
    if chosen.svg:
        chosen.svg.write_text(plot(found))


if __name__ == "__main__":
    main()
