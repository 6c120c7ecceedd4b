"""Types the commands of docs/own_drive.md, of a simulated bag without poses or labels: run by ctest with the program."""

import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = pathlib.Path(sys.argv.pop()).resolve()


def commands():
    """Returns the lines of the page's example without their comments."""
    page = (ROOT / "docs/own_drive.md").read_text()
    block = re.search(r"^```\n(.*?)^```", page, re.MULTILINE | re.DOTALL).group(1)
    return [line.split(" #")[0].strip() for line in block.splitlines()]


class OwnDrive(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "bin").mkdir()
        (self.folder / "bin/mosbench").symlink_to(PROGRAM)
        self.type("mosbench simulate --layout semantickitti --scene room --scans 24 --seed 1 --out sim")
        shutil.rmtree(self.folder / "sim/sequences/08/labels")
        self.type("mosbench convert sim --layout ros2-mcap --out bag")
        next(self.folder.glob("bag/*/*.mcap")).rename(self.folder / "drive.mcap")

    def type(self, line):
        environment = {**os.environ, "PATH": f"{self.folder / 'bin'}:{os.environ['PATH']}"}
        done = subprocess.run(["sh", "-ec", line], cwd=self.folder, env=environment, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, f"{line}\n{done.stdout}{done.stderr}")
        return done.stdout

    def review(self):
        """Agrees with every guess, as a person who looks at the page might."""
        tracks = json.loads((self.folder / "truth/tracks.json").read_text())["tracks"]
        decisions = [{"track": f"{t['sequence']}/{t['number']}", "decided": t["guess"]} for t in tracks]
        self.assertTrue(decisions)
        (self.folder / "truth/decisions.json").write_text(json.dumps({"format": 1, "decisions": decisions}))

    def test_ends_with_the_numbers_that_the_status_told(self):
        lines = commands()
        self.assertEqual(len(lines), 10, lines)
        told = ""
        for line in lines:
            if line == "mosbench truth review truth":
                self.review()
                continue
            said = self.type(line)
            told = said if line.startswith("mosbench truth status") else told
        table = json.loads(self.type("mosbench rank results/scored --json"))
        iou = {row["method"]: 100 * row["all"]["iou"]["value"] for row in table["rows"]}
        self.assertEqual(len(iou), 8)
        for method, value in iou.items():
            self.assertRegex(told, rf"(?m)^{re.escape(method)},.* {value:.1f} +\[")
        self.assertIn("Underwood", (self.folder / "mine.html").read_text())


if __name__ == "__main__":
    unittest.main()
