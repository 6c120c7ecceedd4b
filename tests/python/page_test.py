"""The Python of docs/python.md runs as it stands, given scans and a network."""

import pathlib
import re

import numpy as np

import mosbench

PAGE = pathlib.Path(__file__).resolve().parents[2] / "docs/python.md"


def test_code_of_the_page_runs(street, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "sim").mkdir()
    (tmp_path / "sim/street").symlink_to(street)
    (code,) = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(), re.MULTILINE | re.DOTALL)
    scans = [(scan.points, scan.pose) for scan in mosbench.open(street, sequence="08")]
    exec(compile(code, str(PAGE), "exec"), {"my_scans": scans, "my_network": lambda points: np.zeros(len(points), bool)})
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines[:12]] == [str(index) for index in range(12)]
    assert lines[12] == "0.0"  # of a network that calls nothing moving
    assert re.match(r"0\.\d+ \[", lines[13])
    assert lines[14:] == ["[]"]  # no doubt
