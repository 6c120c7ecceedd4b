#!/usr/bin/env python3
"""Prints how far each threshold of `mosbench doctor` is from sound and from faulty data.

    scripts/check/doctor_plants.py --scenes sound --record cases.jsonl
    scripts/check/doctor_plants.py --scenes chosen --record cases.jsonl
    scripts/check/doctor_margins.py cases.jsonl

The first two commands repeat the calibration: 40 sound sequences, half of them with 5 cm of noise in their poses, and
faults planted into the scenes on which thresholds were chosen. The third shows per threshold its value in the sources,
the sound case that comes nearest to it, and the nearest case with a fault that it is there to find; `--markdown FILE`
keeps the table (datasets/doctor/thresholds.md). Exit code 1 where a sound case was taken for faulty, 2 where the sources
hold a constant that is named neither here nor among those that decide nothing.
"""

import argparse
import json
import pathlib
import re
import sys

DOCTOR = pathlib.Path(__file__).resolve().parents[2] / "datasets/doctor"
LABELS = r"labels_(next|far|shuffled)$"
CONVENTION = r"(inverse|transposed|yaw_(90|180)|scale_1.1|reversed|shift_-?[25])$"
NOISE = r"noise_"


def share(part, whole):
    return part / whole if part is not None and whole else None


def of(name):
    return lambda case: case["measures"].get(name)


def ratio(part, whole):
    return lambda case: share(case["measures"].get(part), case["measures"].get(whole))


def truth(measure):
    return lambda case: measure(case["truth"]) if case.get("truth") else None


# Constant, its file, what is compared with it, how, whether sound data lie below, faults that it finds.
THRESHOLDS = [
    ("kLeastReturns", "doctor_content.cpp", "returns among the points", of("returns"), False, r"big_endian"),
    ("kMostBeyond", "doctor_content.cpp", "returns beyond the sensor's range", of("beyond_sensor"), True, r"points_(mm|in_map)"),
    ("kMostNear", "doctor_content.cpp", "returns nearer than 0.5 m", of("nearest"), True, r"points_km"),
    ("kMostLostBetween", "doctor_content.cpp", "zeros between two returns", of("lost_between"), True, r"zero_points"),
    ("kMostReversed", "doctor_content.cpp", "points in range with reversed bytes only", of("plausible_reversed"), True, r"big_endian"),
    ("kMostAbove", "doctor_content.cpp", "flat places above the sensor", of("flat_above"), True, r"points_z_flipped"),
    ("kShortestStepS", "doctor_stamps.cpp", "time between scans", of("step_s"), False, r"none"),
    ("kLongestStepS", "doctor_stamps.cpp", "time between scans", of("step_s"), True, r"stamps_ms"),
    ("kGapSteps", "doctor_stamps.cpp", "longest / usual time between scans", of("gap_steps"), True, r"stamps_gap"),
    ("kUnsound", "convention_scores.hpp", "deviation of the poses, 1 is noise of 5 cm", of("unsound"), True, NOISE),
    ("kFarMore", "pose_diagnosis.cpp", "the same / that of measured motions", ratio("unsound", "disagreement"), True, NOISE),
    ("kUnsoundScattering", "pose_diagnosis.cpp", "deviation of poses that scatter", of("unsound"), True, NOISE),
    ("kFastestMS", "pose_diagnosis.cpp", "speed", of("speed_m_s"), True, r"feet|millimetres"),
    ("kLeastScatterM", "pose_scatter.cpp", "noise of the positions", of("scatter_m"), True, NOISE),
    ("kLeastWhiteness", "pose_scatter.cpp", "third / second differences", of("whiteness"), True, NOISE),
    ("kLeastAccelerationMS2", "pose_scatter.cpp", "acceleration", of("acceleration_m_s2"), True, NOISE),
    ("kLeastGain", "convention_scores.hpp", "log likelihood gained by the best convention", of("gain"), True, CONVENTION),
    ("kLeastMeanGain", "convention_scores.cpp", "the same per motion", of("mean_gain"), True, CONVENTION),
    ("kLeastMeanGainOfRest", "convention_scores.cpp", "the same of poses that are too long", of("mean_gain"), True, r"feet|millimetres"),
    ("kFitting", "pose_evidence.hpp", "median misfit under the best convention", of("explained_misfit"), True, r"none"),
    ("kExplainedShare", "convention_scores.cpp", "deviation left by the best convention", ratio("explained_unsound", "unsound"), False, CONVENTION),
    ("kSmallestShare", "doctor_folder.cpp", "smallest scan / median of those around", of("smallest_scan"), False, r"cut_scan"),
    ("kLeastRowGain", "misplaced_rows.cpp", "overlap gained without suspected rows", of("row_gain"), True, r"row(s_exchanged|_off)"),
    ("kOverlapShare", "pose_diagnosis.cpp", "overlap as given / at best", of("overlap_share"), False, r"noise_20cm|other_way|rows_shuffled"),
    ("kMoves", "frozen_rows.cpp", "motion of scans while rows are equal", of("moves_in_equal_rows"), True, r"identity|frozen"),
    ("kJumpShare", "frozen_rows.cpp", "step after equal rows / the way left out", of("jump_share"), True, r"frozen"),
    ("kOutlier", "pose_jumps.cpp", "deviation of a single step", of("single_jump"), True, r"jump_"),
    ("kMostMoving", "truth_check.cpp", "labelled points that move",
     truth(lambda t: share(t["moving_points"], t["moving_points"] + t["static_points"])), True, r"labels_(swapped|moving)"),
    ("kTimesStill", "truth_check.cpp", "moving points that leave their place / static ones",
     truth(lambda t: share(t["moving_leaves"], t["static_leaves"])), False, LABELS),
    ("kLeastPurity", "truth_check.cpp", "moving points around a moving one", truth(lambda t: t["purity"] or None), False, LABELS),
]

# Why the other constants need no margin: they alone make no finding.
OTHERS = {
    "doctor_content.cpp": "numbers of scans and points that are looked at",
    "convention_scores.cpp": "conventions near the best one, which are then listed as not to be told apart",
    "fitted_corrections.cpp": "the smallest corrections that are tried; the gain decides",
    "frozen_rows.cpp": "which rows are looked at; kMoves and kJumpShare decide",
    "lost_scan.cpp": "how many rows are tried, and how near to an end; kLeastGain decides",
    "measured_motions.cpp": "how motions are measured; their errors are in kUnsound and kFarMore",
    "measured_motions.hpp": "how motions are measured",
    "misplaced_rows.cpp": "which rows are suspected by the poses alone, checked on 310 exchanged pairs and 80 single rows as written there; "
    "kLeastRowGain decides",
    "pose_conventions.cpp": "numbers of degrees and of rows",
    "pose_conventions.hpp": "how many rows are tried",
    "pose_diagnosis.cpp": "the time between scans where no stamps tell it",
    "pose_evidence.hpp": "the most that one motion counts",
    "pose_jumps.cpp": "how many jumps are named, and how",
    "pose_scatter.cpp": "how many poses a median needs, and the length of noise",
    "registration.cpp": "how scans are registered",
    "row_patterns.cpp": "what a micrometre is",
    "scan_overlap.cpp": "how scans are compared",
    "scan_overlap.hpp": "how scans are compared",
    "surface_cells.cpp": "how scans are compared",
    "cell_moments.cpp": "how scans are compared",
    "truth_check.cpp": "which points are looked at",
    "doctor.cpp": "how many scans are looked at",
    "doctor_folder.cpp": "how many scans on either side are compared",
}


def value_of(constant, file):
    found = re.search(rf"\b{constant} = ([0-9.* a-zA-Z]+);?", (DOCTOR / file).read_text())
    if not found:
        sys.exit(f"{file}: has no {constant}, expected a constant of that name")
    return float(re.match(r"[0-9.]+", found.group(1)).group(0))


def files_without_reason():
    """Files with constants of which nothing is said here."""
    holding = {path.name for path in DOCTOR.glob("*.?pp") if re.search(r"constexpr \w+(::\w+)* k[A-Z]\w* = ", path.read_text())}
    return sorted(holding - set(OTHERS) - {file for _, file, *_ in THRESHOLDS})


def nearest(cases, measure, pick):
    values = [measure(case) for case in cases]
    values = [value for value in values if value is not None]
    return f"{pick(values):.3g}" if values else "none"


def table(cases):
    sound = [case for case in cases if case["case"] == "sound"]
    lines = [f"{len(sound)} sound cases, {len(cases) - len(sound)} with a fault.", "",
             "| threshold | value | compared with | nearest sound | nearest faulty |", "|---|---|---|---|---|"]
    for constant, file, meaning, measure, is_below, faults in THRESHOLDS:
        faulty = [case for case in cases if re.match(faults, case["case"])]
        worst, first = (max, min) if is_below else (min, max)
        lines.append(f"| {constant} ({file}) | {value_of(constant, file):g} | {meaning} | {nearest(sound, measure, worst)} "
                     f"| {nearest(faulty, measure, first)} |")
    lines += ["", "The other constants make no finding alone:", ""]
    return lines + [f"- {file}: {reason}" for file, reason in sorted(OTHERS.items())]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("records", nargs="+", type=pathlib.Path, help="what doctor_plants.py --record wrote")
    parser.add_argument("--markdown", type=pathlib.Path, help="file that the table is written to")
    flags = parser.parse_args()
    cases = [json.loads(line) for path in flags.records for line in path.read_text().splitlines()]
    lines = table(cases)
    print("\n".join(lines))
    if flags.markdown:
        head = ["# Thresholds of the doctor", "",
                "Written by `scripts/check/doctor_margins.py`, which says how to repeat it. Thresholds were chosen on the scenes `sound`",
                "and `chosen` of `scripts/check/doctor_plants.py`; this table is of other worlds and seeds: `--scenes sound --seeds-from",
                "200` and `--scenes judged --seeds-from 100`. Some faults need several thresholds to be passed or are found by any of",
                "several, and some cannot be seen in some scenes, so that a case may lie on the other side of a single one.", ""]
        flags.markdown.write_text("\n".join(head + lines) + "\n")
    if files := files_without_reason():
        print(f"{', '.join(files)}: hold constants of which nothing is said here", file=sys.stderr)
        return 2
    return 1 if any(case["case"] == "sound" and case["verdict"] == "alarm" for case in cases) else 0


if __name__ == "__main__":
    sys.exit(main())
