#!/usr/bin/env python3
"""Writes the scenes that studies name as scenes/KIND-SENSOR-SEED.json, which are too large to be kept.

    scripts/bench/scenes.py results/studies/plus_judged.yaml ...

KIND is a scene that `mosbench simulate` knows, or one made of it here, at random by SEED: a street `parked` full of cars, a
`rough` one with what real streets have, a `lane` where others drive ahead; a mall or street where people stop and go
(`mallstops`, `streetstops`). SEED-5hz changes the time between scans. The same name gives the same scene.
"""

import argparse
import json
import math
import pathlib
import random
import re
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SENSORS = ("os1-64", "os2-128", "hdl-64e", "hdl-32e", "vlp-16", "avia", "aeva", "mid-360")
NAME = re.compile(rf"\bscenes/([a-z]+)-({'|'.join(SENSORS)})-(\d+)(?:-(\d+)hz)?\.json\b")


def park_cars(scene, seed):
    """Fills both kerbs of the street with parked cars and vans, passed closely and faster, with noisier
    ranges and on a slope; five road users stay."""
    draw = random.Random(seed)
    users = [m for m in scene["movers"] if m["route"]["legs"] and m["kind"] in ("cyclist", "car")][:5]
    parked = []
    for side_m in (-5.2, 1.9):
        x_m = 4.0
        while x_m < 215:
            if draw.random() < 0.75:
                kind = "car" if draw.random() < 0.85 else "truck"
                route = {"from_m": [x_m, side_m + draw.uniform(-0.3, 0.3)], "legs": [], "after": "stay", "start_s": 0.0}
                parked.append({"kind": kind, "route": route, "labelled": True})
            x_m += draw.uniform(5.5, 9)
    scene |= {"movers": users + parked, "range_noise_m": 0.03,
              "ground": [{"height_m": 0.0, "slope_x": 0.015, "slope_y": 0.02}]}
    scene["ego"]["route"]["legs"][0]["speed_m_s"] = 12.0


def roughen(scene, seed):
    """Makes of a parked street what real ones have: kerbs and bumps, thin poles, leaves that sway, glass,
    mirrors, beams that fall on two things, people who go slowly, and a car that stops and goes."""
    walkers = [m for m in scene["movers"] if m["kind"] == "pedestrian"][::2]
    park_cars(scene, seed)
    draw = random.Random(seed + 1000)
    for walker in walkers:
        for leg in walker["route"]["legs"]:
            leg["speed_m_s"] *= draw.choice([0.4, 0.6, 1.0])
    scene["movers"] += walkers
    for leg in next(m for m in scene["movers"] if m["kind"] == "car")["route"]["legs"]:
        leg["wait_s"] = 2.0
    scene |= {"ground_bumps_m": 0.03, "beam_width_rad": 0.003}
    scene["ego"]["route"]["legs"][0]["speed_m_s"] = 8.0
    for structure in scene["structures"]:
        if structure["density"] < 1:
            structure["sway_m"] = draw.uniform(0.05, 0.2)

    def add(shape, x_m, y_m, size_m, **keys):
        foot_m = 0.015 * x_m + 0.02 * y_m
        scene["structures"].append({"shape": shape, "center_m": [x_m, y_m, foot_m + size_m[2] / 2],
                                    "size_m": size_m} | keys)
    for x_m in range(0, 216, 4):
        for y_m in (-8.0, 4.7):
            add("box", x_m, y_m, [4.0, 3.0, 0.12])
    for x_m in range(2, 216, 9):
        add("cylinder", x_m, -6.9, [0.06, 0.06, 3.0])
        add("cylinder", x_m + 4, 3.5, [0.1, 0.1, 5.0])
    for x_m in range(10, 216, 30):
        add("box", x_m, -9.4, [6.0, 0.02, 2.4], let_through=0.8)
        add("box", x_m + 12, -9.4, [6.0, 0.1, 2.4], let_through=0.5, mirrors=True)
        add("box", x_m + 5, 5.5, [7.0, 1.0, 1.4], density=0.4, sway_m=0.15)


def fill_lane(scene, seed):
    """A rough street without glass, where two cyclists ride ahead and a car or a truck comes towards them
    (even seeds) or drives ahead, too."""
    draw = random.Random(seed)
    cyclists = [m for m in scene["movers"] if m["route"]["legs"] and m["kind"] == "cyclist"][:2]
    roughen(scene, seed)
    scene["structures"] = [s for s in scene["structures"] if s.get("let_through", 0) == 0]
    parked = [m for m in scene["movers"] if not m["route"]["legs"]]
    draw.shuffle(parked)

    def drive(x_m, y_m, to_m, slowest_m_s, fastest_m_s):
        leg = {"to_m": [to_m, y_m], "speed_m_s": draw.uniform(slowest_m_s, fastest_m_s), "wait_s": 0}
        return {"from_m": [x_m, y_m], "legs": [leg], "after": "stay", "start_s": 0}
    for i, cyclist in enumerate(cyclists):
        x_m = 12 + 14 * i + draw.uniform(0, 8)
        cyclist["route"] = drive(x_m, -1.75 if draw.random() < 0.5 else -3.2, 220.0, 3, 6)
    if seed % 2:
        place = draw.uniform(30, 45), -1.75, 220.0
    else:
        place = draw.uniform(60, 110), 1.9, -20.0
        parked = [m for m in parked if m["route"]["from_m"][1] < 0]
    kind = draw.choice(["car", "truck"])
    vehicle = {"kind": kind, "route": drive(*place, 5, 9), "labelled": True}
    scene["movers"] = cyclists + [vehicle] + parked[:draw.randint(14, 30)]
    scene |= {"range_noise_m": 0.02, "ground_bumps_m": 0.02}
    scene["ego"]["route"]["legs"][0]["speed_m_s"] = draw.choice([6.0, 9.0, 12.0])


def stop_and_go(scene, seed):
    """Lets pedestrians stop for 2 to 7 s at most places some 4 m apart."""
    draw = random.Random(seed)
    for route in (m["route"] for m in scene["movers"] if m["kind"] == "pedestrian"):
        at, legs = route["from_m"], []
        for leg in route["legs"]:
            to = leg["to_m"]
            pieces = max(1, round(math.dist(at, to) / draw.uniform(3, 5)))
            for i in range(1, pieces + 1):
                wait_s = round(draw.uniform(2, 7), 1) if draw.random() < 0.7 else 0.0
                legs.append({"to_m": [a + (b - a) * i / pieces for a, b in zip(at, to)],
                             "speed_m_s": leg["speed_m_s"], "wait_s": wait_s})
            at = to
        route["legs"] = legs


MADE_OF = {"parked": ("street", park_cars), "rough": ("street", roughen), "lane": ("street", fill_lane),
           "mallstops": ("mall", stop_and_go), "streetstops": ("street", stop_and_go)}


def known_scene(program, name, seed):
    """A scene that the program knows, as it writes it beside simulated scans."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([program, "simulate", "--layout", "semantickitti", "--seed", str(seed), "--out", f"{folder}/seen",
                        "--scene", name, "--scans", "1"], check=True, capture_output=True)
        return json.loads(pathlib.Path(folder, "seen/scene.json").read_text())


def scene_of(program, kind, sensor, seed, hertz):
    known, change = MADE_OF.get(kind, (kind, None))
    scene = known_scene(program, known, seed) | {"sensor": sensor}
    if hertz:
        scene["scan_period_s"] = 1 / int(hertz)
    if change:
        change(scene, int(seed))
    return scene


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(ROOT / "build/release/eval/mosbench"))
    parser.add_argument("study", type=pathlib.Path, nargs="+", help="a study's YAML file; scenes/ is beside it")
    chosen = parser.parse_args()
    for study in chosen.study:
        for match in NAME.finditer(study.read_text()):
            file = study.parent / match.group()
            if not file.exists():
                file.parent.mkdir(exist_ok=True)
                begun = file.with_suffix(".begun")
                begun.write_text(json.dumps(scene_of(chosen.program, *match.groups())))
                begun.rename(file)


if __name__ == "__main__":
    main()
