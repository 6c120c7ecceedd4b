#!/usr/bin/env python3
"""Every `file:name` that core/README.md links to is defined or declared in that file."""

import pathlib
import re
import sys

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "core"
DEFINITIONS = 16  # rows of the table of section III
REFERENCE = re.compile(r"\[`([\w/.]+):(\w+)`\]\(([^)\s]+)\)")
LINK = re.compile(r"\]\(([^)\s]+)\)")
COMMENT_OR_STRING = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"', re.DOTALL)
# Words that may stand before a call, but not before the name of what is declared.
NO_TYPE = {"return", "else", "throw", "case", "co_return", "new", "delete", "not", "and", "or"}


def declares(text, name):
    """Whether C++ source declares or defines a type, a function or a constructor of this name."""
    code = COMMENT_OR_STRING.sub(" ", text)
    if re.search(rf"\b(?:struct|class|enum(?: class)?|using)\s+{name}\b(?!\s*;)", code):
        return True
    if re.search(rf"^{name}::{name}\s*\(", code, re.MULTILINE):
        return True
    function = re.compile(rf"^[ ]*(?:[\w:<>,&*\[\]() ]*?[ ]?)?\b([\w>\]]+)[ &*]+(?:\w+::)*{name}\s*\(", re.MULTILINE)
    return any(match.group(1) not in NO_TYPE for match in function.finditer(code))


def wrong_references(readme, folder):
    """Sentences about the references of a README that lead nowhere."""
    sentences = []
    for file, name, target in REFERENCE.findall(readme):
        if file != target:
            sentences.append(f"`{file}:{name}` links to {target}")
        elif not (folder / file).is_file():
            sentences.append(f"`{file}:{name}`: there is no such file")
        elif not declares((folder / file).read_text(), name):
            sentences.append(f"`{file}:{name}`: {file} declares no {name}")
    for target in LINK.findall(readme):
        if "://" not in target and not (folder / target).exists():
            sentences.append(f"{target}: there is no such file")
    rows = re.findall(r"^\| .*\|$", readme.partition("## The paper's definitions")[2].partition("\n## ")[0],
                      re.MULTILINE)[1:]
    if len(rows) != DEFINITIONS:
        sentences.append(f"{len(rows)} definitions of the paper, expected {DEFINITIONS}")
    sentences += [f"no reference in: {row}" for row in rows if not REFERENCE.search(row)]
    return sentences


def main():
    readme = (FOLDER / "README.md").read_text()
    sentences = wrong_references(readme, FOLDER)
    for sentence in sentences:
        print(f"core/README.md: {sentence}")
    print(f"{len(REFERENCE.findall(readme))} references of core/README.md checked, {len(sentences)} wrong")
    return 1 if sentences else 0


if __name__ == "__main__":
    sys.exit(main())
