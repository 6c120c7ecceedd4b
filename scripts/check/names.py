#!/usr/bin/env python3
"""Checks that no name in the C++ sources or among the file names says nothing: util, helper, tmp, ..."""

import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
BANNED = {"util", "utils", "helper", "helpers", "manager", "handler", "tmp"}
# Left out: literals, comments, preprocessor lines, test names (sentences), and names behind . -> ::
# (members of other libraries, or ours, which are checked where they are declared).
NOISE = re.compile(
    r'R"(?P<tag>\w*)\(.*?\)(?P=tag)"|"(?:\\.|[^"\\\n])*"|//[^\n]*|/\*.*?\*/'
    r"|(?:\.|->|::)\s*\w+|\bTEST(?:_[FP])?\([^)]*\)|^\s*#[^\n]*",
    re.DOTALL | re.MULTILINE,
)
IDENTIFIER = re.compile(r"[A-Za-z_]\w*")
WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+")


def banned_words(identifier):
    return BANNED & {word.lower() for word in WORD.findall(identifier)}


def main():
    files = subprocess.run(
        ["git", "-C", ROOT, "ls-files"], check=True, capture_output=True, text=True
    ).stdout.split()
    wrong = 0
    for name in files:
        if words := banned_words(name):
            print(f"{name}: file name says {', '.join(sorted(words))}")
            wrong += 1
        if not name.endswith((".hpp", ".cpp")):
            continue
        text = (ROOT / name).read_text()
        code = NOISE.sub(lambda match: re.sub(r"[^\n]", " ", match.group()), text)
        for number, line in enumerate(code.splitlines(), start=1):
            for identifier in IDENTIFIER.findall(line):
                if words := banned_words(identifier):
                    print(f"{name}:{number}: {identifier} says {', '.join(sorted(words))}")
                    wrong += 1
    print(f"names in {len(files)} files checked, {wrong} wrong")
    return 1 if wrong or not files else 0


if __name__ == "__main__":
    sys.exit(main())
