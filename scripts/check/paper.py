#!/usr/bin/env python3
"""Every `file:name` that a page of docs/methods links to is defined or declared in that file."""

import pathlib
import re
import sys

PAGES = pathlib.Path(__file__).resolve().parents[2] / "docs/methods"
PAPER = "hmm_mos.md"  # the page with the table of section III
DEFINITIONS = 16  # rows of the table of section III
REFERENCE = re.compile(r"\[`([\w/.]+):(\w+)`\]\(([^)\s]+)\)")
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


def wrong_references(page, folder):
    """Sentences about the references of a page in this folder that lead nowhere."""
    sentences = []
    for file, name, target in REFERENCE.findall(page):
        if not f"/{target}".endswith(f"/{file}"):
            sentences.append(f"`{file}:{name}` links to {target}")
        elif not (folder / target).is_file():
            sentences.append(f"`{file}:{name}`: there is no such file")
        elif not declares((folder / target).read_text(), name):
            sentences.append(f"`{file}:{name}`: {file} declares no {name}")
    return sentences


def wrong_definitions(page):
    """Sentences about the paper's definitions: rows that are missing, or that refer to nothing."""
    rows = re.findall(r"^\| .*\|$", page.partition("## The paper's definitions")[2].partition("\n## ")[0],
                      re.MULTILINE)[1:]
    sentences = [f"no reference in: {row}" for row in rows if not REFERENCE.search(row)]
    if len(rows) != DEFINITIONS:
        sentences.append(f"{len(rows)} definitions of the paper, expected {DEFINITIONS}")
    return sentences


def main():
    pages = {file.name: file.read_text() for file in sorted(PAGES.glob("*.md"))}
    sentences = [f"{name}: {sentence}" for name, page in pages.items() for sentence in wrong_references(page, PAGES)]
    sentences += [f"{PAPER}: {sentence}" for sentence in wrong_definitions(pages[PAPER])]
    count = sum(len(REFERENCE.findall(page)) for page in pages.values())
    print("\n".join([*sentences, f"{count} references of docs/methods checked, {len(sentences)} wrong"]))
    return 1 if sentences else 0


if __name__ == "__main__":
    sys.exit(main())
