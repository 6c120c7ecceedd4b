"""headings.py on a sequence whose objects head where they are told: run by ctest."""

import array
import importlib.util
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts/bench/headings.py"
SCANS = 12
TURNED = "0 -1 0 0  0 0 -1 0  1 0 0 0"  # x ahead becomes z ahead of a camera
# Number to (points in a scan, first place, metres per scan); the sensor moves 0.1 m per scan along x.
OBJECTS = {1: (20, (10, 0, 0), (0.2, 0, 0)), 2: (19, (20, 0, 0), (-0.2, 0, 0)),
           3: (21, (0, 10, 0), (0.2, 0, 0)), 4: (30, (60, 0, 0), (-0.2, 0, 0))}


def write(folder, found):
    """Writes the sequence, and labels that call the objects in `found` and a static point moving."""
    for name in ("velodyne", "labels", "run"):
        (folder / name).mkdir()
    (folder / "calib.txt").write_text(f"P0: 1\nTr: {TURNED}\n")
    # Of the camera: the same way, along z.
    (folder / "poses.txt").write_text("".join(f"1 0 0 0  0 1 0 0  0 0 1 {0.1 * k}\n" for k in range(SCANS)))
    for k in range(SCANS):
        points, truth, labels = array.array("f", [5, 5, 0, 0]), array.array("I", [40]), array.array("I", [251])
        for number, (count, first, step) in OBJECTS.items():
            place = [a + k * b for a, b in zip(first, step)]
            place[0] -= 0.1 * k
            points.extend([*place, 0] * count)
            truth.extend([number << 16 | 252] * count)
            labels.extend([251 if number in found else 9] * count)
        (folder / "velodyne" / f"{k:06}.bin").write_bytes(points.tobytes())
        (folder / "labels" / f"{k:06}.label").write_bytes(truth.tobytes())
        (folder / "run" / f"{k:06}.label").write_bytes(labels.tobytes())


def headings(folder):
    return subprocess.run([sys.executable, str(SCRIPT), str(folder), str(folder / "run")],
                          capture_output=True, text=True, check=False)


@unittest.skipUnless(importlib.util.find_spec("numpy"), "needs numpy")
class Headings(unittest.TestCase):
    def test_tell_what_recedes_from_what_approaches_and_crosses(self):
        with tempfile.TemporaryDirectory() as name:
            write(pathlib.Path(name), found={1, 3})
            # 60 moving points in range, 7 of 12 scans with a past of half a second; object 4 stays beyond 50 m.
            self.assertEqual(headings(pathlib.Path(name)).stdout.splitlines()[2:], [
                "| across | 20 or more | 20.4 | 100.0 |",
                "| approaching | below 20 | 18.5 | 0.0 |",
                "| receding | 20 or more | 19.4 | 100.0 |",
                "| seen for less than half a second | 20 or more | 28.5 | 100.0 |",
                "| seen for less than half a second | below 20 | 13.2 | 0.0 |"])

    def test_refuse_labels_of_other_scans(self):
        with tempfile.TemporaryDirectory() as name:
            write(pathlib.Path(name), found=set())
            (pathlib.Path(name) / "run/000003.label").write_bytes(b"\0" * 8)
            refused = headings(pathlib.Path(name))
            self.assertEqual(refused.returncode, 1)
            self.assertIn("000003.label: 2 labels and 91 true ones, expected 91 of both", refused.stderr)


if __name__ == "__main__":
    unittest.main()
