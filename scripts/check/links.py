#!/usr/bin/env python3
"""Every relative link of a Markdown file leads to a file and, after a #, to a heading of it."""

import pathlib
import re
import subprocess
import sys

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


def main():
    files = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "*.md"], cwd=ROOT, check=True, capture_output=True, text=True).stdout.split()
    sentences = [sentence for file in files if (ROOT / file).exists() for sentence in wrong_links(ROOT / file)]
    print("\n".join([*sentences, f"links of {len(files)} files checked, {len(sentences)} wrong"]))
    return 1 if sentences else 0


if __name__ == "__main__":
    sys.exit(main())
