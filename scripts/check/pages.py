#!/usr/bin/env python3
"""Checks all Markdown pages: relative links lead to a file and, after a #, to a heading of it; the README of a folder
has at most 25 lines; the pages of docs, without its history, have at most 10,500 words together, all pages 22,000.
Words of docs/reference do not count: a script writes them, people look them up."""

import pathlib
import re
import subprocess
import sys

MOST_LINES, MOST_WORDS, MOST_OF_ALL = 25, 10500, 22000
ROOT = pathlib.Path(__file__).resolve().parents[2]
LINK = re.compile(r"\]\(([^)\s]+)\)")
CODE = re.compile(r"^```.*?^```|`[^`\n]*`", re.DOTALL | re.MULTILINE)


def anchors(text):
    """The names that GitHub gives the headings of a text."""
    headings = re.findall(r"^#+ (.*)$", CODE.sub(lambda code: code.group().strip("`"), text), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-") for heading in headings}


def wrong_links(file):
    """Sentences about the links of a file that lead nowhere."""
    sentences = []
    for link in LINK.findall(re.sub(r"^```.*?^```", "", file.read_text(), flags=re.DOTALL | re.MULTILINE)):
        path, _, anchor = link.partition("#")
        target = file.parent / path if path else file
        if "://" in link:
            continue
        if not target.exists():
            sentences.append(f"{file}: {link}: there is no such file")
        elif anchor and target.suffix == ".md" and anchor not in anchors(target.read_text()):
            sentences.append(f"{file}: {link}: no heading is called so")
    return sentences


def too_long(pages):
    """Sentences about READMEs and pages of docs, text by path, that are longer than a reader should meet."""
    sentences = [f"{path}: {len(text.splitlines())} lines, expected at most {MOST_LINES}" for path, text in pages.items()
                 if path.endswith("/README.md") and not path.startswith("docs/history/") and len(text.splitlines()) > MOST_LINES]
    words = {path: len(text.split()) for path, text in pages.items() if not path.startswith("docs/reference/")}
    of_docs = sum(count for path, count in words.items() if path.startswith("docs/") and not path.startswith("docs/history/"))
    of_all = sum(words.values())
    return sentences + [f"{what}: {count} words, expected at most {most}" for what, count, most in
                        (("docs without history", of_docs, MOST_WORDS), ("all pages", of_all, MOST_OF_ALL)) if count > most]


def main():
    files = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "*.md"], cwd=ROOT, check=True, capture_output=True,
                           text=True).stdout.split()
    pages = {file: (ROOT / file).read_text() for file in files if (ROOT / file).exists()}
    sentences = [sentence for file in pages for sentence in wrong_links(ROOT / file)] + too_long(pages)
    print("\n".join([*sentences, f"{len(pages)} pages checked, {len(sentences)} wrong"]))
    return 1 if sentences else 0


if __name__ == "__main__":
    sys.exit(main())
