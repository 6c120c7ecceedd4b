#!/usr/bin/env python3
"""Says how many moving points of a sequence a run found, by where their objects headed.

    scripts/bench/headings.py SEQUENCE LABELS [--min-range-m 1.5] [--max-range-m 50]

SEQUENCE is a folder in the layout of SemanticKITTI (velodyne, labels with object numbers, poses.txt,
calib.txt), LABELS the folder of a run's .label files. An object recedes where at least 0.7 of its
speed in the last half second leads away from the sensor: it then enters space that it hid before.
"""

import argparse
import pathlib

import numpy as np

PAST_SCANS = 5
SMALL_POINTS = 20


def matrices(lines):
    return np.array([[*line.split(), 0, 0, 0, 1] for line in lines], float).reshape(-1, 4, 4)


def poses(sequence):
    """map_from_sensor of every scan."""
    lines = (sequence / "calib.txt").read_text().splitlines()
    camera_from_sensor = matrices([next(line for line in lines if line.startswith("Tr:"))[3:]])[0]
    return np.linalg.inv(camera_from_sensor) @ matrices((sequence / "poses.txt").read_text().splitlines()) @ camera_from_sensor


def objects(sequence, labels, scan, limits_m):
    """Moving objects of a scan: number to (points, how many were found, mean x y z 1)."""
    points = np.fromfile(sequence / "velodyne" / f"{scan:06}.bin", "<f4").reshape(-1, 4).astype(float)
    truth, found = (np.fromfile(folder / f"{scan:06}.label", "<u4") for folder in (sequence / "labels", labels))
    if not len(points) == len(truth) == len(found):
        raise SystemExit(f"{labels}/{scan:06}.label: {len(found)} labels and {len(truth)} true ones, "
                         f"expected {len(points)} of both")
    points[:, 3] = 1
    range_m = np.linalg.norm(points[:, :3], axis=1)
    moves, is_found = ((ids & 0xFFFF) // 10 == 25 for ids in (truth, found))
    judged = moves & (limits_m[0] < range_m) & (range_m < limits_m[1])
    numbers = np.where(judged, truth >> 16, -1)
    return {number: ((numbers == number).sum(), is_found[numbers == number].sum(), points[numbers == number].mean(axis=0))
            for number in np.unique(numbers[judged])}


def heading(past, now, sensor):
    """Where an object moves between two places on the map, as the sensor sees it."""
    moved, line = now - past, now - sensor
    along = moved @ line / np.linalg.norm(line)
    if abs(along) < 0.7 * np.linalg.norm(moved[:2]):
        return "across"
    return "receding" if along > 0 else "approaching"


def counted(sequence, labels, limits_m):
    """(heading, whether its object has few points in the scan) to [points, how many were found]."""
    tracks, counts = {}, {}
    for scan, pose in enumerate(poses(sequence)):
        for number, (points, found, mean) in objects(sequence, labels, scan, limits_m).items():
            now = (pose @ mean)[:3]
            track = tracks.setdefault(number, [])
            old = [place for seen, place in track if seen <= scan - PAST_SCANS]
            track.append((scan, now))
            where = heading(old[-1], now, pose[:3, 3]) if old else "seen for less than half a second"
            count = counts.setdefault((where, bool(points < SMALL_POINTS)), np.zeros(2))
            count += points, found
    return counts


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sequence", type=pathlib.Path)
    parser.add_argument("labels", type=pathlib.Path)
    parser.add_argument("--min-range-m", type=float, default=1.5)
    parser.add_argument("--max-range-m", type=float, default=50)
    chosen = parser.parse_args()
    counts = counted(chosen.sequence, chosen.labels, (chosen.min_range_m, chosen.max_range_m))
    total = sum(points for points, _ in counts.values())
    print("| object | its points in a scan | share of the moving points, % | found, % |\n|---|---|---|---|")
    for (where, is_small), (points, found) in sorted(counts.items()):
        size = f"below {SMALL_POINTS}" if is_small else f"{SMALL_POINTS} or more"
        print(f"| {where} | {size} | {100 * points / total:.1f} | {100 * found / points:.1f} |")


if __name__ == "__main__":
    main()
