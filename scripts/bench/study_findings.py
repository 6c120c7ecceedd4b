#!/usr/bin/env python3
"""Says in numbers what a computed study found: how much of each disturbance a method stands, whose order changes, and
which settings matter.

Takes the study's file and the folder of its results, and prints tables in Markdown. The strength that costs 10 points
of IoU, or half of it, is read off the curve of means with straight lines between strengths; a method that never loses
so much gets the strongest with ">". --write also puts the tables between the study's marks of
docs/history/studies.md, what `mosbench study table` says (rounded) into results/studies/NAME.json, and the curves
into results/studies/NAME.svg.
"""

import argparse
import csv
import html
import json
import os
import pathlib
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
COLOURS = ["#0072B2", "#E8590C", "#00805E", "#A8478A", "#8A6D00", "#4A5360", "#7A3B1D", "#5B2FB0"]
DASHES = ["", "7 3", "2 3", "10 3 2 3", "5 5", "12 4", "4 2", "1 3"]  # as the page of a study
LOST_POINTS = 0.10
# Student's t at 97.5 % by degrees of freedom, from one on.
STUDENT = [12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.160, 2.145, 2.131]
NOT_FROM_ZERO = ("beams", "every_nth_scan")  # whose scans are whole at another number than 0
CLEAR = 0.02  # methods that are nearer than this are called equal


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("study", type=pathlib.Path, help="the study's YAML file")
    parser.add_argument("out", type=pathlib.Path, help="folder of its results, as of `mosbench study run --out`")
    parser.add_argument("--program", default=str(ROOT / "build/release/eval/mosbench"))
    parser.add_argument("--write", action="store_true", help="into --folder")
    parser.add_argument("--folder", type=pathlib.Path, default=ROOT / "results/studies",
                        help="of NAME.json and NAME.svg (default: results/studies)")
    parser.add_argument("--page", type=pathlib.Path, default=ROOT / "docs/history/studies.md",
                        help="with the study's marks (default: docs/history/studies.md)")
    return parser.parse_args()


def printed_table(chosen, form):
    """What `mosbench study table` prints, also where cells are missing."""
    done = subprocess.run([chosen.program, "study", "table", chosen.study, "--out", chosen.out, "--format", form],
                          capture_output=True, text=True, check=False)
    if done.returncode > 1:
        sys.exit(f"study_findings.py: {done.stderr.strip()}")
    return done.stdout


def table_of(chosen):
    """What a study found; ends the script where cells are missing."""
    found = json.loads(printed_table(chosen, "json"))
    if found["done"] < found["cells"]:
        sys.exit(f"study_findings.py: {found['done']} of {found['cells']} cells of {chosen.study} are done in {chosen.out}, "
                 "expected all: mosbench study run")
    return found


def cells_of(chosen):
    """IoU by (method, axis, value), then by sequence: the mean of its seeds; None where one is undefined."""
    cells = {}
    for cell in csv.DictReader(printed_table(chosen, "csv").splitlines()):
        label = f"{cell['method']} ({cell['odometry']})" if cell["odometry"] else cell["method"]
        by_sequence = cells.setdefault((label, cell["axis"], cell["value"]), {})
        iou = float(cell["iou"]) if cell["iou"] else None
        by_sequence.setdefault((cell["group"], cell["sequence"]), []).append(iou)
    return {key: {name: None if None in seeds else statistics.mean(seeds) for name, seeds in by_sequence.items()}
            for key, by_sequence in cells.items()}


def paired_change(cells, label, axis, value):
    """Mean change of IoU against the undisturbed cells of the same sequences, and half of its 95 % interval."""
    before, now = cells.get((label, "", ""), {}), cells.get((label, axis, value), {})
    changes = [now[name] - before[name] for name in now if None not in (now[name], before.get(name))]
    if len(changes) < 3 or len(changes) > len(STUDENT) + 1:
        return (statistics.mean(changes) if changes else None), None
    half = STUDENT[len(changes) - 2] * statistics.stdev(changes) / len(changes) ** 0.5
    return statistics.mean(changes), half


def ious(line):
    return [point["iou"]["value"] for point in line["points"]]


def is_disturbance(curve):
    """Disturbances have units, a probability that of 1; settings have none."""
    return curve["unit"] != ""


def strengths(curve):
    return [0.0, *map(float, curve["values"][1:])]


def strength_at(places, values, goal):
    """Where the curve first falls to `goal`, on straight lines; None where it never does."""
    for i in range(1, len(values)):
        if values[i] is None or values[i - 1] is None:
            return None
        if values[i] <= goal:
            share = (values[i - 1] - goal) / (values[i - 1] - values[i])
            return places[i - 1] + share * (places[i] - places[i - 1])
    return None


def strength_text(curve, line, goal):
    places, values = strengths(curve), ious(line)
    if not values[0]:  # not known, or nothing to lose
        return "-"
    found = strength_at(places, values, goal(values[0]))
    if found is not None:
        return f"{found:.2g}"
    return "-" if None in values else f"> {places[-1]:g}"


def percent(value):
    return "-" if value is None else f"{100 * value:.1f}"


def markdown(rows):
    lines = ["| " + " | ".join(map(str, row)) + " |" for row in rows]
    return "\n".join([lines[0], "|" + "---|" * len(rows[0]), *lines[1:]])


def overview(found):
    rows = [["method", "IoU %", "95 %", "to best", "mean rank"]]
    for row in sorted(found["rows"], key=lambda row: -(row["metrics"]["iou"]["value"] or 0)):
        iou, best = row["metrics"]["iou"], row["to_best"]
        span = f"{percent(iou['low'])} to {percent(iou['high'])}" if "low" in iou else ""
        rank = "-" if row["rank"] is None else f"{row['rank']:.2f}"
        rows.append([f"`{row['label']}`", percent(iou["value"]), span, percent(best["value"]) if best else "", rank])
    return markdown(rows)


def by_method(found, curves, title, text):
    """A row per method, a column per curve."""
    rows = [[title, *(f"{curve['axis']}" for curve in curves)]]
    for i, row in enumerate(found["rows"]):
        rows.append([f"`{row['label']}`", *(text(curve, curve["lines"][i]) for curve in curves)])
    return markdown(rows)


def losses(found, cells, curves, share):
    """Change of IoU at the strength that lies this share of the way along each axis."""
    places = [round(share * (len(curve["values"]) - 1)) for curve in curves]
    rows = [["change of IoU in points, at", *(f"{curve['axis']} {curve['values'][place]}"
                                              for curve, place in zip(curves, places))]]
    for row in found["rows"]:
        texts = []
        for curve, place in zip(curves, places):
            change, half = paired_change(cells, row["label"], curve["axis"], curve["values"][place])
            texts.append("-" if change is None else
                         f"{100 * change:+.1f}" + ("" if half is None else f" ± {100 * half:.1f}"))
        rows.append([f"`{row['label']}`", *texts])
    return markdown(rows)


def order(curve, place):
    """Labels from the best on, with their IoU."""
    found = [(ious(line)[place], line["label"]) for line in curve["lines"] if ious(line)[place] is not None]
    return sorted(found, key=lambda one: -one[0])


def turned_pairs(curve, place):
    """Pairs (now ahead, now behind) whose order is clearly another one than without the disturbance."""
    before, now = ({label: iou for iou, label in order(curve, at)} for at in (0, place))
    return [(a, b) for a in now for b in now if a in before and b in before
            and now[a] - now[b] > CLEAR and before[b] - before[a] > CLEAR]


def ranking(curves):
    rows = [["disturbance", "strength", "best", "second", "pairs that changed order", "for example"]]
    for curve in curves:
        for place in sorted({len(curve["values"]) // 2, len(curve["values"]) - 1}):
            best = [f"`{label}` {percent(iou)}" for iou, label in order(curve, place)[:2]]
            turned = turned_pairs(curve, place)
            count = len(curve["lines"])
            example = f"`{turned[0][0]}` before `{turned[0][1]}`" if turned else ""
            rows.append([curve["axis"], curve["values"][place], *(best + ["", ""])[:2],
                         f"{len(turned)} of {count * (count - 1) // 2}", example])
    return markdown(rows)


def span_text(curve, line):
    """Lowest and highest IoU over the values of a setting, with the value of the highest."""
    known = [(iou, value) for iou, value in zip(ious(line), curve["values"]) if iou is not None]
    if len(known) < 2:
        return "-"
    low, high = min(known), max(known)
    return f"{percent(low[0])} to {percent(high[0])} ({high[1]})"


def effects(found):
    rows = [["total effect", *(f"`{one['label']}`" for one in found["effects"])]]
    names = []
    for one in found["effects"]:
        names += [setting["name"] for setting in one["settings"] if setting["name"] not in names]
    for name in names:
        row = [name]
        for one in found["effects"]:
            setting = next((each for each in one["settings"] if each["name"] == name), {"total_effect": None})
            row.append("-" if setting["total_effect"] is None else
                       f"{setting['total_effect']:.2f} ({setting['low']:.2f} to {setting['high']:.2f})")
        rows.append(row)
    return markdown(rows)


def text_of(found, cells, svg_name):
    parts = []
    if found["simulated"]:
        parts.append("**Simulated**; not comparable with published numbers.")
    parts[-1:] = [" ".join([*parts[-1:], f"{found['cells']} cells, computed by version {found['version']}. Moving IoU, "
                            "means over sequences, each the mean of its seeds."])]
    parts += [f"![IoU over strengths, a line per method]({svg_name})", overview(found)]
    disturbed = [curve for curve in found["curves"] if is_disturbance(curve)]
    settings = [curve for curve in found["curves"] if not is_disturbance(curve)]
    if disturbed:
        units = ", ".join(f"{curve['axis']} in {curve['unit']}" for curve in disturbed if curve["unit"] != "1")
        by_strength = [curve for curve in disturbed if curve["axis"] not in NOT_FROM_ZERO]
        parts += [f"Units: {units}." if units else "",
                  by_method(found, by_strength, "strength that costs 10 points",
                            lambda curve, line: strength_text(curve, line, lambda iou: iou - LOST_POINTS)),
                  by_method(found, by_strength, "strength that halves the IoU",
                            lambda curve, line: strength_text(curve, line, lambda iou: iou / 2)),
                  losses(found, cells, disturbed, 0.6), losses(found, cells, disturbed, 1),
                  "± is half of the 95 % interval of the paired change over sequences.",
                  f"Order by strength, and pairs that are now the other way round by more than {100 * CLEAR:.0f} points:",
                  ranking(disturbed)]
    if settings:
        parts.append(by_method(found, settings, "IoU % over the values of a setting (best value)", span_text))
    if found["effects"]:
        parts.append(effects(found))
    return "\n\n".join(part for part in parts if part)


def rounded(value):
    """Numbers with four digits after the point, which is more than a mean holds."""
    if isinstance(value, float):
        return round(value, 4)
    if isinstance(value, list):
        return [rounded(one) for one in value]
    if isinstance(value, dict):
        return {key: rounded(one) for key, one in value.items()}
    return value


def compact_json(found):
    """A line per row, curve and effect. Commands of single scans are of this machine, and times of a busy one."""
    kept = {key: value for key, value in found.items() if key not in ("worst", "failures", "cpu_s", "predicted_cpu_s")}
    for row in kept["rows"]:
        row.pop("ms_per_scan", None)
        row.pop("front", None)
    lines = []
    for key, value in rounded(kept).items():
        if isinstance(value, list) and value:
            value = "[\n" + ",\n".join("  " + json.dumps(one, separators=(",", ":")) for one in value) + "\n ]"
        else:
            value = json.dumps(value)
        lines.append(f' "{key}": {value}')
    return "{\n" + ",\n".join(lines) + "\n}\n"


def panel(left, top, curve):
    """IoU over the values of a curve, 240 x 190, each value at the same distance; a setting's default stands apart."""
    count = len(curve["values"])
    x_of = lambda i: left + 44 + 184 * i / max(1, count - 1)
    y_of = lambda iou: top + 150 - 120 * iou
    title = html.escape(curve["axis"] + (f", {curve['unit']}" if curve["unit"] not in ("", "1") else ""))
    parts = [f'<text x="{left + 136}" y="{top + 18}" class="title">{title}</text>']
    for tick in (0, 0.25, 0.5, 0.75, 1):
        parts.append(f'<path d="M{left + 44} {y_of(tick):.1f}h184" stroke="#ddd"/>'
                     f'<text x="{left + 38}" y="{y_of(tick) + 4:.1f}" class="tick">{100 * tick:.0f}</text>')
    first = 0 if is_disturbance(curve) else 1
    for i, value in enumerate(curve["values"]):
        parts.append(f'<text x="{x_of(i):.1f}" y="{top + 168}">{html.escape(value)}</text>')
    for i, line in enumerate(curve["lines"]):
        points = [f"{x_of(k):.1f},{y_of(iou):.1f}" for k, iou in enumerate(ious(line)) if iou is not None and k >= first]
        parts.append(f'<polyline points="{" ".join(points)}" {stroke(i)}/>')
        if first and ious(line)[0] is not None:
            parts.append(f'<circle cx="{x_of(0):.1f}" cy="{y_of(ious(line)[0]):.1f}" r="3" fill="{COLOURS[i % len(COLOURS)]}"/>')
    return "".join(parts)


def stroke(i):
    dash = DASHES[i % len(DASHES)]
    return f'stroke="{COLOURS[i % len(COLOURS)]}"' + (f' stroke-dasharray="{dash}"' if dash else "")


def plot(found):
    """All curves in rows of four, and what the lines are."""
    panels = [panel(240 * (i % 4), 190 * (i // 4), curve) for i, curve in enumerate(found["curves"])]
    place = len(panels)
    left, top = 240 * (place % 4) + 40, 190 * (place // 4) + 20
    for i, row in enumerate(found["rows"]):
        y = top + 12 + 18 * i
        panels.append(f'<path d="M{left} {y - 4}h34" fill="none" stroke-width="2" {stroke(i)}/>'
                      f'<text x="{left + 42}" y="{y}" class="legend">{html.escape(row["label"])}</text>')
    width, height = 240 * min(4, place + 1), 190 * (place // 4 + 1)
    kind = "simulated, " if found["simulated"] else ""
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" '
            'font-size="11"><style>text{text-anchor:middle;fill:#444}.title{font-weight:bold}.tick{text-anchor:end}'
            '.legend{text-anchor:start}polyline{fill:none;stroke-width:2}</style>'
            f'<title>{html.escape(found["name"])}: {kind}IoU in per cent</title>'
            f'<rect width="{width}" height="{height}" fill="#fff"/>' + "\n".join(panels) + "</svg>\n")


def write_between(file, name, text):
    content = file.read_text()
    begin, end = (f"<!-- {name} {edge} -->" for edge in ("begins", "ends"))
    if content.count(begin) != 1 or content.count(end) != 1:
        sys.exit(f"{file}: lacks the {name} marks, expected {begin} and {end} once each")
    before, rest = content.split(begin)
    file.write_text(f"{before}{begin}\n{text}\n{end}{rest.split(end)[1]}")


def main():
    chosen = arguments()
    found = table_of(chosen)
    name = found["name"]
    text = text_of(found, cells_of(chosen), os.path.relpath(chosen.folder / f"{name}.svg", chosen.page.parent))
    print(text)
    if chosen.write:
        write_between(chosen.page, name, text)
        (chosen.folder / f"{name}.svg").write_text(plot(found))
        (chosen.folder / f"{name}.json").write_text(compact_json(found))


if __name__ == "__main__":
    main()
