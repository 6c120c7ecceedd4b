#!/usr/bin/env python3
"""Draws the ten largest false positives of hmm-mos-plus on the judged sequences of plus_study.py.

    scripts/bench/plus_pictures.py --work FOLDER [--out docs/history/plus]

FOLDER is that of plus_study.py, or gets its sequences. One cluster of false points is drawn per scan
and thing: false_01.png is the largest. Left from above, right from the side, 12 m wide, in the colours of
the report: blue true, orange false, red missed. Prints what the truth calls the false points.
"""

import argparse
import array
import collections
import json
import pathlib
import struct
import subprocess
import zlib

import plus_study

PICTURES, PIXELS, WIDTH_M = 10, 240, 12.0
COLOURS = [(0xF7, 0xF8, 0xFA), (0x9A, 0xA3, 0xAF), (0x00, 0x72, 0xB2), (0xE8, 0x59, 0x0C), (0xA0, 0x00, 0x08)]
BACKGROUND, STATIC, TRUE, FALSE, MISSED = range(5)
APART_M = 5.0  # false points of other scans this near are of the same thing


def png(rows):
    """The bytes of a picture of palette indices."""
    def chunk(kind, content):
        return (struct.pack(">I", len(content)) + kind + content
                + struct.pack(">I", zlib.crc32(kind + content)))
    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 3, 0, 0, 0)
    pixels = zlib.compress(b"".join(b"\0" + bytes(row) for row in rows), 9)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"PLTE", b"".join(map(bytes, COLOURS)))
            + chunk(b"IDAT", pixels) + chunk(b"IEND", b""))


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def matrix(numbers):
    return [list(numbers[4 * i:4 * i + 4]) for i in range(3)] + [[0.0, 0.0, 0.0, 1.0]]


def inverse(m):
    turned = [[m[j][i] for j in range(3)] for i in range(3)]
    shift = [-sum(turned[i][j] * m[j][3] for j in range(3)) for i in range(3)]
    return [[*turned[i], shift[i]] for i in range(3)] + [[0.0, 0.0, 0.0, 1.0]]


def map_from_lidar(sequence, scan):
    """The pose of a scan; rows are of the camera, as SemanticKITTI's."""
    calibration = dict(line.split(":") for line in (sequence / "calib.txt").read_text().splitlines())
    camera_from_lidar = matrix([float(number) for number in calibration["Tr"].split()])
    row = (sequence / "noisy_poses.txt").read_text().splitlines()[scan]
    pose = matrix([float(number) for number in row.split()])
    return product(inverse(camera_from_lidar), product(pose, camera_from_lidar))


def numbers_of(file, kind):
    numbers = array.array(kind)
    numbers.frombytes(file.read_bytes())
    return numbers


def points_of(sequence, labels, scan):
    """(x, y, z in the map, colour, id of the truth) of each point."""
    stem = f"{scan:06d}"
    m = map_from_lidar(sequence, scan)
    xyzi = numbers_of(sequence / "velodyne" / f"{stem}.bin", "f")
    truth = numbers_of(sequence / "labels" / f"{stem}.label", "I")
    found = numbers_of(labels / f"{stem}.label", "I")
    for i, (of_truth, label) in enumerate(zip(truth, found)):
        p = xyzi[4 * i:4 * i + 3]
        moves, called = (of_truth & 0xFFFF) >= 251, label == 251
        colour = (TRUE if moves else FALSE) if called else (MISSED if moves else STATIC)
        yield [sum(m[r][c] * p[c] for c in range(3)) + m[r][3] for r in range(3)], colour, of_truth & 0xFFFF


def picture(points, centre):
    """From above and from the side, what is wrong on top."""
    rows = [[BACKGROUND] * (2 * PIXELS) for _ in range(PIXELS)]
    for wanted in (STATIC, TRUE, MISSED, FALSE):
        for at, colour, _ in points:
            if colour != wanted:
                continue
            u, v, w = (int((at[axis] - centre[axis]) / WIDTH_M * PIXELS + PIXELS / 2) for axis in range(3))
            for column, up, inside in ((u, v, 0 <= w < PIXELS), (u + PIXELS, w, 0 <= v < PIXELS)):
                if inside and 0 <= u < PIXELS and 0 <= up < PIXELS:
                    rows[PIXELS - 1 - up][column] = colour
    return png(rows)


def clusters_of(program, work, row):
    """Runs the method; false clusters of a sequence with their places, the largest first."""
    sequence = plus_study.simulated(program, work, row)
    sets = f"voxel_size_m={row[8]},min_range_m={0.5 if row[8] == 0.2 else 1.5},max_range_m={row[9]}"
    labels = work / "pictures" / row[1]
    reading = [sequence, "--dataset", "semantickitti", "--poses", sequence / "noisy_poses.txt"]
    subprocess.run([program, "run", *reading, "--method", "hmm-mos-plus", "--set", sets, "--overwrite",
                    "--out", labels], check=True, capture_output=True)
    answer = subprocess.run([program, "breakdown", *reading, "--predictions", labels, "--top", "40", "--json"],
                            check=True, capture_output=True)
    found = json.loads(answer.stdout)["sequences"][0]["false_positive_clusters"]
    return [cluster | {"name": row[1], "sequence": sequence, "labels": labels / "08" / "labels"}
            for cluster in found]


def are_of_one_thing(a, b):
    apart = [abs(p - q) for p, q in zip(a["position_map_m"], b["position_map_m"])]
    return a["name"] == b["name"] and max(apart) < APART_M


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(plus_study.ROOT / "build/release/eval/mosbench"))
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, default=plus_study.ROOT / "docs/history/plus")
    chosen = parser.parse_args()
    chosen.work.mkdir(parents=True, exist_ok=True)
    clusters = []
    for row in (row for row in plus_study.SEQUENCES if row[0] == "judged"):
        clusters += clusters_of(chosen.program, chosen.work, row)
    clusters.sort(key=lambda cluster: -cluster["points"])
    worst = []
    for cluster in clusters:
        if len(worst) < PICTURES and not any(are_of_one_thing(cluster, other) for other in worst):
            worst.append(cluster)
    print("| picture | sequence, scan | false points | range, m | truth |\n|---|---|---|---|---|")
    for number, cluster in enumerate(worst, 1):
        points = list(points_of(cluster["sequence"], cluster["labels"], int(cluster["scan"])))
        centre = cluster["position_map_m"]
        near = collections.Counter(truth for at, colour, truth in points if colour == FALSE
                                   and all(abs(p - q) < WIDTH_M / 2 for p, q in zip(at, centre)))
        name = f"false_{number:02d}.png"
        (chosen.out / name).write_bytes(picture(points, centre))
        truth = ", ".join(f"{label}: {count}" for label, count in near.most_common(3))
        print(f"| ![]({name}) | {cluster['name']}, {cluster['scan']} | {cluster['points']} | "
              f"{cluster['range_m']:.0f} | {truth} |", flush=True)


if __name__ == "__main__":
    main()
