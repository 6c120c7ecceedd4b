"""scenes.py writes every scene that a study names, once and always the same: run by ctest."""

import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts/bench"))
import scenes  # noqa: E402

ROUTE = {"from_m": [0, 0], "legs": [{"to_m": [30, 0], "speed_m_s": 1, "wait_s": 0}], "after": "stay", "start_s": 0}
SCENE = {"name": "seen", "scan_period_s": 0.1, "structures": [], "ego": {"route": ROUTE},
         "movers": [{"kind": kind, "route": ROUTE} for kind in ("car", "cyclist", "cyclist", "pedestrian")]}
# In the place of mosbench: writes a scene.
PROGRAM = """#!/bin/sh
while [ $# -gt 0 ]; do [ "$1" = --out ] && out=$2; shift; done
mkdir -p "$out"
cp "{scene}" "$out/scene.json"
"""


class Scenes(unittest.TestCase):
    def written(self, *names):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "scene").write_text(json.dumps(SCENE))
            program, study = folder / "program", folder / "study.yaml"
            program.write_text(PROGRAM.format(scene=folder / "scene"))
            program.chmod(0o755)
            study.write_text("".join(f"  - {{simulate: {{scene: scenes/{name}.json}}}}\n" for name in names))
            subprocess.run([sys.executable, ROOT / "scripts/bench/scenes.py", study, "--program", program], check=True)
            return {file.stem: json.loads(file.read_text()) for file in sorted(folder.glob("scenes/*"))}

    def test_are_of_the_sensor_and_the_time_between_scans_that_their_names_say(self):
        found = self.written("mall-os1-64-7", "street-vlp-16-28-5hz")
        self.assertEqual(found["mall-os1-64-7"], SCENE | {"sensor": "os1-64"})
        self.assertEqual(found["street-vlp-16-28-5hz"], SCENE | {"sensor": "vlp-16", "scan_period_s": 0.2})

    def test_of_one_name_are_the_same_and_of_another_seed_are_not(self):
        for kind in scenes.MADE_OF:
            names = f"{kind}-avia-7", f"{kind}-avia-8"
            first, again = self.written(*names), self.written(*names)
            self.assertEqual(first, again, kind)
            self.assertNotEqual(*first.values(), kind)
            self.assertNotEqual(first[names[0]]["movers"], SCENE["movers"], kind)

    def test_every_scene_that_a_study_names_is_one_that_the_script_writes(self):
        named = {study.name: re.findall(r"scenes/[^,}\s]*", study.read_text()) for study in ROOT.glob("results/studies/*.yaml")}
        self.assertGreater(sum(map(len, named.values())), 80)
        for study, files in named.items():
            self.assertEqual([file for file in files if not scenes.NAME.fullmatch(file)], [], study)


if __name__ == "__main__":
    unittest.main()
