#!/usr/bin/env python3
"""site_pages.py FOLDER: copies what a site of the manual needs, each file at its place: README.md, docs, and all that
links lead to from there."""

import pathlib
import re
import shutil
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)#\s]+)(#[^)\s]*)?\)")


def with_links(text, page, found):
    """Returns the text of a page with links to folders led to their README, or taken off where there is none."""
    def lead(link):
        mark, words, path, anchor = link.groups()
        if "://" in path:
            return link.group()
        target = (page.parent / path).resolve()
        if target.is_dir():
            target, path = target / "README.md", f"{path.rstrip('/')}/README.md"
        if not target.is_file():
            return words
        found.append(target)
        return f"{mark}[{words}]({path}{anchor or ''})"
    return LINK.sub(lead, text)


def with_deep_lists(text):
    """Returns the text with four spaces where GitHub takes three within a list, and a blank line before the next item."""
    parts = re.split(r"(^```.*?^```)", text, flags=re.DOTALL | re.MULTILINE)
    for index in range(0, len(parts), 2):
        deep = re.sub(r"^ {3}(?=\S|  \S)", "    ", parts[index], flags=re.MULTILINE)
        parts[index] = re.sub(r"^( {4}.*\n)(?=\d+\. )", r"\1\n", deep, flags=re.MULTILINE)
    return "".join(parts)


def main(folder):
    to_do = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md", *(ROOT / "docs").rglob("*.md")]
    done = set()
    while to_do:
        file = to_do.pop()
        if file in done:
            continue
        done.add(file)
        copy = folder / file.relative_to(ROOT)
        copy.parent.mkdir(parents=True, exist_ok=True)
        if file.suffix == ".md":
            copy.write_text(with_deep_lists(with_links(file.read_text(), file, to_do)))
        else:
            shutil.copyfile(file, copy)


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))
