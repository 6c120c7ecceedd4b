"""plus_study.py tells a sequence that was made of something else: run by ctest."""

import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts/bench"))
import plus_study  # noqa: E402

ROW = ("judged", "room-avia", "room", "avia", 7, 3, 0.1, (0.02, 0.0017), 0.25, 50)
# In the place of mosbench: writes a scene and poses.
PROGRAM = """#!/bin/sh
while [ $# -gt 0 ]; do [ "$1" = --out ] && out=$2; shift; done
mkdir -p "$out/sequences/08"
echo '{"name": "room", "wall_m": WALL}' > "$out/scene.json"
echo 1 0 0 0 0 1 0 0 0 0 1 0 > "$out/sequences/08/poses.txt"
"""


class Simulated(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.work = pathlib.Path(scratch.name)

    def simulated(self, row=ROW, wall_m=4):
        program = self.work / "program"
        program.write_text(PROGRAM.replace("WALL", str(wall_m)))
        program.chmod(0o755)
        return plus_study.simulated(program, self.work, row)

    def test_takes_the_sequence_that_is_there(self):
        poses = self.simulated() / "noisy_poses.txt"
        poses.write_text("kept")
        self.assertEqual(self.simulated() / "noisy_poses.txt", poses)
        self.assertEqual(poses.read_text(), "kept")
        self.assertEqual(self.simulated((*ROW[:8], 0.2, 20)), poses.parent, "reading is no part of the data")

    def test_refuses_one_of_another_row_or_scene(self):
        self.simulated()
        others = [(*ROW[:4], 8, *ROW[5:]), (*ROW[:5], 4, *ROW[6:]), (*ROW[:6], 0.2, *ROW[7:]), (*ROW[:7], (0, 0), *ROW[8:])]
        for other in others:
            with self.subTest(other), self.assertRaisesRegex(SystemExit, "room-avia: was made of another row or scene"):
                self.simulated(other)
        with self.assertRaisesRegex(SystemExit, "another row or scene"):
            self.simulated(wall_m=5)

    def test_refuses_one_that_does_not_say_what_it_was_made_of(self):
        (self.simulated().parents[1] / plus_study.MADE_OF).unlink()
        with self.assertRaisesRegex(SystemExit, "expected made_of.json there"):
            self.simulated()


if __name__ == "__main__":
    unittest.main()
