#!/usr/bin/env python3
"""Compares `run --moving ever` with hmm-mos-plus and hmm-mos where people stop and go and truth is by object.

    scripts/bench/plus_ever.py --work FOLDER

Simulates sequences as those of DOALS (truth by appearance: a person who stands is dynamic, too) into FOLDER,
once, runs the methods and prints IoU (precision, recall) in % over all scans, within 20 m. Nothing was chosen
on the rows called judged.
"""

import argparse
import json
import math
import pathlib
import random
import shutil
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
METHODS = {"paper": ["--method", "hmm-mos"], "plus": ["--method", "hmm-mos-plus"],
           "ever:5": ["--method", "hmm-mos-plus", "--moving", "ever:5"],
           "ever": ["--method", "hmm-mos-plus", "--moving", "ever"]}
# name, scene, sensor, seed
SEQUENCES = [("looked at, mall", "mall", "os1-64", 101), ("looked at, street", "street", "os1-64", 102),
             ("judged, mall", "mall", "os1-64", 111), ("judged, mall", "mall", "vlp-16", 112),
             ("judged, street", "street", "os1-64", 113)]
SCANS = 150


def stop_and_go(scene, seed):
    """Lets pedestrians stop for 2 to 7 s at most places some 4 m apart."""
    draw = random.Random(seed)
    for mover in scene["movers"]:
        if mover["kind"] != "pedestrian":
            continue
        at, legs = mover["route"]["from_m"], []
        for leg in mover["route"]["legs"]:
            to = leg["to_m"]
            pieces = max(1, round(math.dist(at, to) / draw.uniform(3, 5)))
            for i in range(1, pieces + 1):
                wait_s = round(draw.uniform(2, 7), 1) if draw.random() < 0.7 else 0.0
                legs.append({"to_m": [a + (b - a) * i / pieces for a, b in zip(at, to)],
                             "speed_m_s": leg["speed_m_s"], "wait_s": wait_s})
            at = to
        mover["route"]["legs"] = legs


def simulated(program, work, scene_name, sensor, seed):
    """The folder of a simulated data set, made when it is not there yet."""
    folder, begun = work / f"{scene_name}-{seed}", work / f"{scene_name}-{seed}.begun"
    if folder.exists():
        return folder
    shutil.rmtree(begun, ignore_errors=True)
    command = [program, "simulate", "--layout", "doals", "--seed", str(seed), "--out", begun]
    subprocess.run([*command, "--scene", scene_name, "--scans", "1"], check=True, capture_output=True)
    scene = json.loads(next(begun.rglob("scene.json")).read_text())
    shutil.rmtree(begun)
    stop_and_go(scene, seed)
    file = work / f"{scene_name}-{seed}.json"
    file.write_text(json.dumps(scene | {"sensor": sensor}))
    subprocess.run([*command, "--scene", file, "--scans", str(SCANS)], check=True, capture_output=True)
    begun.rename(folder)
    return folder


def score(program, work, data, arguments):
    out = work / "run"
    subprocess.run([program, "run", data, *arguments, "--set", "voxel_size_m=0.2,min_range_m=0.5,max_range_m=20",
                    "--protocol", "doals-dynablox", "--overwrite", "--out", out], check=True, capture_output=True)
    scans = json.loads(next(out.rglob("result.json")).read_text())["scans"]
    shutil.rmtree(out)
    tp, fp, fn = (sum(scan.get(key, 0) for scan in scans) for key in ("tp", "fp", "fn"))
    iou, precision, recall = (100 * tp / max(1, whole) for whole in (tp + fp + fn, tp + fp, tp + fn))
    return f"{iou:.1f} ({precision:.1f}, {recall:.1f})"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(ROOT / "build/release/eval/mosbench"))
    parser.add_argument("--work", type=pathlib.Path, required=True, help="folder for simulated sequences")
    chosen = parser.parse_args()
    chosen.work.mkdir(parents=True, exist_ok=True)
    print(f"| sequence | {' | '.join(METHODS)} |\n|---|{'---|' * len(METHODS)}")
    for name, scene_name, sensor, seed in SEQUENCES:
        data = simulated(chosen.program, chosen.work, scene_name, sensor, seed)
        cells = [score(chosen.program, chosen.work, data, arguments) for arguments in METHODS.values()]
        print(f"| {name}, {sensor}, seed {seed} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
