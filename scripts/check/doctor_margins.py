#!/usr/bin/env python3
"""Prints how far each threshold of `mosbench doctor` is from sound and from faulty data.

    scripts/check/doctor_plants.py --scenes sound --record cases.jsonl
    scripts/check/doctor_plants.py --scenes chosen --record cases.jsonl
    scripts/check/doctor_margins.py cases.jsonl

The first two commands repeat the calibration: 40 sound sequences, half of them with 2 cm of noise in their poses, and
faults planted into the scenes on which thresholds were chosen. The third shows per threshold of `doctor --json` the sound
case that comes nearest to it, and the nearest case with a fault that it is there to find. Some faults need several
thresholds to be passed or are found by any of several, and some cannot be seen in some scenes, so that a case may lie on
the other side of a single one. Thresholds of other worlds and seeds: `--scenes sound --seeds-from 200` and `--scenes
judged --seeds-from 100`. Exit code 1 where a sound case was taken for faulty.
"""

import argparse
import json
import pathlib
import re
import sys

LABELS = r"labels_(next|far|shuffled)$"
CONVENTION = r"(inverse|transposed|yaw_(90|180)|scale_1.1|reversed|shift_-?[25])$"
NOISE = r"noise_"
# The faults that a measure is there to find; of others no margin is told.
FAULTS = {
    "returns": r"big_endian", "beyond_sensor": r"points_(mm|in_map)", "nearest": r"points_km", "lost_between": r"zero_points",
    "plausible_reversed": r"big_endian", "flat_above": r"points_z_flipped", "step_s": r"stamps_ms", "gap_steps": r"stamps_gap",
    "unsound": NOISE, "far_more": NOISE, "speed_m_s": r"feet|millimetres", "scatter_m": NOISE, "whiteness": NOISE,
    "acceleration_m_s2": NOISE, "gain": CONVENTION, "mean_gain": CONVENTION, "explained_misfit": r"none",
    "explained_share": CONVENTION, "smallest_scan": r"cut_scan", "row_gain": r"row(s_exchanged|_off)",
    "overlap_share": r"noise_20cm|other_way|rows_shuffled", "moves_in_equal_rows": r"identity|frozen", "jump_share": r"frozen",
    "single_jump": r"jump_", "missing_turn": r"no_rotation", "moving_share": r"labels_(swapped|moving)", "leaves_ratio": LABELS,
    "purity": LABELS, "off_share": NOISE, "far_off_places": NOISE,
}  # fmt: skip


def nearest(cases, measure, pick):
    values = [case["measures"][measure] for case in cases if case["measures"].get(measure) is not None]
    return f"{pick(values):.3g}" if values else "none"


def table(cases):
    sound = [case for case in cases if case["case"].startswith("sound")]
    lines = [f"{len(sound)} sound cases, {len(cases) - len(sound)} with a fault.", "",
             "| check | measure | faulty | nearest sound | nearest faulty |", "|---|---|---|---|---|"]
    for row in cases[0]["thresholds"]:
        measure, above = row["measure"], row["faulty"] == "above"
        if measure not in FAULTS:
            continue
        faulty = [case for case in cases if re.match(FAULTS[measure], case["case"])]
        worst, first = (max, min) if above else (min, max)
        lines.append(f"| {row['check']} | {measure} | {row['faulty']} {row['threshold']:g} | {nearest(sound, measure, worst)} "
                     f"| {nearest(faulty, measure, first)} |")
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("records", nargs="+", type=pathlib.Path, help="what doctor_plants.py --record wrote")
    cases = [json.loads(line) for path in parser.parse_args().records for line in path.read_text().splitlines()]
    print("\n".join(table(cases)))
    return 1 if any(case["verdict"] == "ALARM" for case in cases) else 0


if __name__ == "__main__":
    sys.exit(main())
