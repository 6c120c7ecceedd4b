"""The examples of the IoU gate for CI servers, step by step, and its test cases: run by ctest with the program."""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as xml

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = pathlib.Path(sys.argv.pop()).resolve()
ODD = "a<b>&\"c'd\u00e9\ufffe]]>"


def examples():
    """Returns the shell lines of each example by the comment in its first line."""
    page = (ROOT / "docs/studies/answers.md").read_text()
    blocks = re.findall(r"^```yaml\n# (\S+)\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    lines = {name: re.findall(r"^ +- (?:run: )?(?!uses:)(.+)$", block, re.MULTILINE) for name, block in blocks}
    assert set(lines) == {".github/workflows/mos.yml", ".gitlab-ci.yml"}, lines
    return lines


class GateExamples(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.clone = pathlib.Path(folder.name)
        (self.clone / "results").symlink_to(ROOT / "results")
        (self.clone / "build/release/eval").mkdir(parents=True)
        (self.clone / "build/release/eval/mosbench").symlink_to(PROGRAM)
        (self.clone / "scripts").mkdir()
        for name in ("setup.sh", "build.sh"):  # what they make is there
            (self.clone / "scripts" / name).write_text("#!/bin/sh\necho $0 $* >> ran\n")
            (self.clone / "scripts" / name).chmod(0o755)
        self.environment = {**os.environ, "GITHUB_STEP_SUMMARY": str(self.clone / "summary.md")}

    def run_line(self, line):
        done = subprocess.run(["sh", "-ec", line], cwd=self.clone, env=self.environment, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, f"{line}\n{done.stdout}{done.stderr}")
        return done.stdout

    def test_github_steps_each_in_a_shell_of_their_own(self):
        lines = examples()[".github/workflows/mos.yml"]
        self.assertEqual(len(lines), 4)
        for line in lines:
            self.run_line(line)
        self.assertEqual((self.clone / "ran").read_text().count("\n"), 2)
        self.assertIn("### MOS gate: pass", (self.clone / "summary.md").read_text())

    def test_gitlab_steps_in_one_shell(self):
        self.run_line("\n".join(examples()[".gitlab-ci.yml"]))
        suite = xml.parse(self.clone / "gate.xml").getroot().find("testsuite")
        self.assertEqual((suite.get("failures"), suite.find("testcase").get("name")), ("0", "08"))

    def test_any_name_of_a_sequence_is_well_formed(self):
        mosbench = self.clone / "build/release/eval/mosbench"
        self.run_line(f"{mosbench} simulate --layout semantickitti --scene room --scans 3 --seed 1 --out sim")
        shutil.move(self.clone / "sim/sequences/08", self.clone / ODD)
        for out in ("before", "after"):
            command = [mosbench, "run", self.clone / ODD, "--out", self.clone / out]
            subprocess.run(command, check=True, capture_output=True)
        name = xml.fromstring(self.run_line(f"{mosbench} compare before after --as junit")).find(".//testcase").get("name")
        self.assertEqual(name, ODD.replace("\ufffe", "\\ufffe"))


if __name__ == "__main__":
    unittest.main()
