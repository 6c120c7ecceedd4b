#!/usr/bin/env python3
"""Checks the types of the Python package, and of its examples against them, by `mypy --strict` and pyright.

Debian's Python has mypy and numpy: scripts/setup.sh --checks installs both, and pyright.
"""

import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PYTHON = "/usr/bin/python3" if pathlib.Path("/usr/bin/python3").exists() else sys.executable
PYRIGHT = ROOT / "tests/python/node_modules/.bin/pyright"
MYPY = [PYTHON, "-m", "mypy", "--cache-dir=build/mypy"]


def examples():
    """Those that use the package."""
    return [file for file in sorted((ROOT / "tests/examples").rglob("*.py")) if "import mosbench" in file.read_text()]


if subprocess.run([*MYPY, "--version"], capture_output=True, check=False).returncode != 0:
    print(f"types not checked: {PYTHON} has no mypy, scripts/setup.sh --checks installs it")
    sys.exit(77)
# Each example is a program of its own, so that names may recur.
failed = subprocess.run(MYPY, cwd=ROOT, check=False).returncode
for file in examples():
    failed |= subprocess.run([*MYPY, "--strict", str(file.relative_to(ROOT))], cwd=ROOT, check=False).returncode
if PYRIGHT.exists():
    failed |= subprocess.run([PYRIGHT, "--pythonpath", PYTHON], cwd=ROOT, check=False).returncode
else:
    print("not checked by pyright: scripts/setup.sh --checks installs it")
sys.exit(1 if failed else 0)
