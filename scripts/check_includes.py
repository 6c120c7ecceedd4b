#!/usr/bin/env python3
"""Includes go core <- datasets <- eval, with bench and tests on top; core neither reads nor prints."""

import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
MAY_INCLUDE = {
    "core": {"core"},
    "datasets": {"core", "datasets"},
    "eval": {"core", "datasets", "eval"},
    "bench": {"core", "datasets", "eval", "bench"},
    "tests": {"core", "datasets", "eval", "bench", "tests"},
}
GENERATED = {"mosbench_version.hpp": {"eval", "tests"}}
# <header> or <folder/...> that only some layers may use.
EXTERNAL = {
    "CLI": {"eval", "tests"},
    "pcl": {"datasets", "tests"},
    "fmt": {"datasets", "eval", "bench", "tests"},
    "nlohmann": {"datasets", "eval", "bench", "tests"},
    "xxhash.h": {"datasets", "eval", "tests"},
    **{
        header: {"datasets", "eval", "bench", "tests"}
        for header in ("cstdio", "filesystem", "fstream", "iostream", "print", "stdio.h", "syncstream")
    },
}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def complaint(layer, quote, header):
    """What is wrong with this include in a file of this layer; None when nothing is."""
    top = header.split("/")[0]
    if quote == "<":
        if layer not in EXTERNAL.get(top, {layer}):
            return f"{layer} must not use <{header}>"
        return f"project header in angle brackets: <{header}>" if top in MAY_INCLUDE else None
    if header in GENERATED:
        return None if layer in GENERATED[header] else f'{layer} must not use "{header}"'
    if top not in MAY_INCLUDE or not (ROOT / header).is_file():
        return f'"{header}" is not a path from the project\'s top folder'
    return None if top in MAY_INCLUDE[layer] else f"{layer} must not include {top}"


def main():
    patterns = [f"{layer}/*.{ending}" for layer in MAY_INCLUDE for ending in ("hpp", "cpp")]
    listed = subprocess.run(
        ["git", "-C", ROOT, "ls-files", *patterns], check=True, capture_output=True, text=True
    ).stdout.split()
    # The consumer of the installed library is a project of its own.
    files = [name for name in listed if not name.startswith("tests/install/")]
    wrong = 0
    for name in files:
        for number, line in enumerate((ROOT / name).read_text().splitlines(), start=1):
            if (match := INCLUDE.match(line)) and (text := complaint(name.split("/")[0], *match.groups())):
                print(f"{name}:{number}: {text}")
                wrong += 1
    print(f"includes of {len(files)} files checked, {wrong} wrong")
    return 1 if wrong or not files else 0


if __name__ == "__main__":
    sys.exit(main())
