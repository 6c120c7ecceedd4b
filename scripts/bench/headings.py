#!/usr/bin/env python3
"""Says how many moving points of a sequence a run found, by where their objects headed.

    scripts/bench/headings.py SEQUENCE LABELS [--min-range-m 1.5] [--max-range-m 50]

SEQUENCE is a folder in the layout of SemanticKITTI (velodyne, labels with object numbers, poses.txt,
calib.txt), LABELS the folder of a run's .label files. An object recedes where at least 0.7 of its
speed in the last half second leads away from the sensor: it then enters space that it hid before.
"""

import argparse
import array
import math
import pathlib

MOVING = range(250, 260)
PAST_SCANS = 5
SMALL_POINTS = 20


def matrix(text):
    numbers = [float(word) for word in text.split()]
    return [numbers[0:4], numbers[4:8], numbers[8:12]]


def product(a, b):
    """a b of two rigid motions, three rows of four each."""
    return [[sum(a[i][k] * b[k][j] for k in range(3)) + (a[i][3] if j == 3 else 0) for j in range(4)]
            for i in range(3)]


def inverse(a):
    turned = [[a[j][i] for j in range(3)] for i in range(3)]
    return [row + [-sum(row[k] * a[k][3] for k in range(3))] for row in turned]


def poses(sequence):
    """map_from_sensor of every scan."""
    lines = (sequence / "calib.txt").read_text().splitlines()
    camera_from_sensor = matrix(next(line for line in lines if line.startswith("Tr:"))[3:])
    back = inverse(camera_from_sensor)
    return [product(product(back, matrix(line)), camera_from_sensor)
            for line in (sequence / "poses.txt").read_text().splitlines()]


def numbers(file, kind):
    values = array.array(kind)
    values.frombytes(file.read_bytes())
    return values


def objects(sequence, labels, scan, limits_m):
    """Moving objects of a scan: number to (points, how many were found, mean x y z in metres)."""
    points = numbers(sequence / "velodyne" / f"{scan:06}.bin", "f")
    truth = numbers(sequence / "labels" / f"{scan:06}.label", "I")
    found = numbers(labels / f"{scan:06}.label", "I")
    if len(points) != 4 * len(truth) or len(truth) != len(found):
        raise SystemExit(f"{labels}/{scan:06}.label: {len(found)} labels and {len(truth)} true ones, "
                         f"expected {len(points) // 4} of both")
    sums = {}
    for i, label in enumerate(truth):
        point = points[4 * i:4 * i + 3]
        if (label & 0xFFFF) not in MOVING or not limits_m[0] < math.hypot(*point) < limits_m[1]:
            continue
        entry = sums.setdefault(label >> 16, [0, 0, 0.0, 0.0, 0.0])
        entry[0] += 1
        entry[1] += (found[i] & 0xFFFF) in MOVING
        for axis in range(3):
            entry[2 + axis] += point[axis]
    return {number: (entry[0], entry[1], [total / entry[0] for total in entry[2:]])
            for number, entry in sums.items()}


def heading(past, now, sensor):
    """Where an object moves between two places on the map, as the sensor sees it."""
    moved = [a - b for a, b in zip(now, past)]
    line = [a - b for a, b in zip(now, sensor)]
    along = sum(a * b for a, b in zip(moved, line)) / math.hypot(*line)
    if abs(along) < 0.7 * math.hypot(*moved[:2]):
        return "across"
    return "receding" if along > 0 else "approaching"


def counted(sequence, labels, limits_m):
    """(heading, whether its object has few points in the scan) to [points, how many were found]."""
    tracks, counts = {}, {}
    for scan, pose in enumerate(poses(sequence)):
        sensor = [row[3] for row in pose]
        for number, (points, found, mean) in objects(sequence, labels, scan, limits_m).items():
            now = [sum(row[k] * mean[k] for k in range(3)) + row[3] for row in pose]
            track = tracks.setdefault(number, [])
            old = [place for seen, place in track if seen <= scan - PAST_SCANS]
            track.append((scan, now))
            where = heading(old[-1], now, sensor) if old else "seen for less than half a second"
            count = counts.setdefault((where, points < SMALL_POINTS), [0, 0])
            count[0] += points
            count[1] += found
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
