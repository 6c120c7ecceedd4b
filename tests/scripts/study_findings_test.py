"""study_findings.py on a table whose curves are known: run by ctest."""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts/bench/study_findings.py"


def metrics(iou):
    return {metric: {"value": iou, "count": 4} for metric in ("iou", "precision", "recall")}


def line(label, ious):
    return {"label": label, "points": [metrics(iou) for iou in ious]}


def row(label, iou):
    return {"label": label, "metrics": metrics(iou), "to_best": None, "ms_per_scan": 9.0, "front": True, "rank": 1.5}


TABLE = {
    "name": "tried", "version": "1", "simulated": True, "cells": 20, "done": 20, "cpu_s": 1.0,
    "rows": [row("falls", 0.8), row("stands", 0.6)],
    "curves": [
        {"axis": "pose_noise_m", "unit": "m", "values": ["none", "0.1", "0.2"],
         "lines": [line("falls", [0.8, 0.75, 0.25]), line("stands", [0.6, 0.6, None])]},
        {"axis": "dropout_probability", "unit": "1", "values": ["none", "0.5"],
         "lines": [line("falls", [0.8, 0.3]), line("stands", [0.6, 0.59])]},
        {"axis": "voxel_size_m", "unit": "", "values": ["default", "0.4"],
         "lines": [line("falls", [0.8, 0.7]), line("stands", [0.6, 0.65])]}],
    "effects": [{"label": "falls", "points": 8, "settings": [
        {"name": "voxel_size_m", "total_effect": 0.7, "low": 0.5, "high": 0.91234567}]}],
    "worst": [{"command": "mosbench run /here"}], "failures": []}

# Of the end of each disturbance: two seeds of one of three sequences, which fall by 0.5, 0.4 and 0.6. The second
# is simulated with two seeds of its own.
CELLS = """data,group,sequence,method,odometry,axis,value,seed,iou
a,a,08,falls,,,,0,0.8
b-1,b,08,falls,,,,0,0.7
b-2,b,08,falls,,,,0,0.9
c,c,08,falls,,,,0,0.8
a,a,08,falls,,dropout_probability,0.5,1,0.2
a,a,08,falls,,dropout_probability,0.5,2,0.4
b-1,b,08,falls,,dropout_probability,0.5,1,0.5
b-2,b,08,falls,,dropout_probability,0.5,1,0.3
c,c,08,falls,,dropout_probability,0.5,1,0.2
a,a,08,stands,,,,0,0.6
a,a,08,stands,,dropout_probability,0.5,1,0.59
b-1,b,08,stands,,dropout_probability,0.5,1,
"""


class Findings(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.folder = pathlib.Path(self.scratch.name)

    def run_on(self, table):
        (self.folder / "json").write_text(json.dumps(table))
        (self.folder / "csv").write_text(CELLS)
        program = self.folder / "program"  # in the place of mosbench
        (self.folder / "text").write_text("what the table says\nresults in /here\n")
        program.write_text(f'#!/bin/sh\ncat "{self.folder}/$6"\n')
        program.chmod(0o755)
        return subprocess.run([sys.executable, str(SCRIPT), "tried.yaml", "out", "--program", str(program),
                               "--svg", str(self.folder / "tried.svg")], capture_output=True, text=True, check=False)

    def test_reads_strengths_off_the_curves(self):
        done = self.run_on(TABLE)
        self.assertEqual(done.returncode, 0, done.stderr)
        ten, half, strongest = (part.splitlines()[2:] for part in done.stdout.split("\n\n")[2:5])
        # 0.8 - 0.1 lies at a tenth of the way from 0.1 to 0.2, 0.4 at seven tenths.
        self.assertEqual(ten, ["| `falls` | 0.11 | 0.1 |", "| `stands` | - | > 0.5 |"])
        self.assertEqual(half, ["| `falls` | 0.17 | 0.4 |", "| `stands` | - | > 0.5 |"])
        self.assertEqual(strongest, ["| `falls` | - | -50.0 ± 24.8 |", "| `stands` | - | -1.0 |"])

    def test_tells_the_table_without_the_folders_of_this_machine_and_draws_the_curves(self):
        done = self.run_on(TABLE)
        self.assertIn("```\nwhat the table says\n```", done.stdout)
        self.assertNotIn("/here", done.stdout)
        self.assertEqual((self.folder / "tried.svg").read_text().count("<polyline"), 6)

    def test_refuses_a_study_that_is_not_done(self):
        done = self.run_on({**TABLE, "done": 19})
        self.assertEqual(done.returncode, 1)
        self.assertIn("19 of 20 cells", done.stderr)


if __name__ == "__main__":
    unittest.main()
