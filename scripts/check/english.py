#!/usr/bin/env python3
"""Checks English: of Markdown and help texts phrases that CONTRIBUTING.md bans and sentences of more than 25 words, a
list after a colon left out; of these and of code the spelling, by codespell where it is there."""

import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
MOST_WORDS = 25
BANNED = {
    r"\bof which\b": "of which",
    r"\bare said\b": "are said",
    r"(?:^|(?<=[.!?] ))What [^.?!,:]* is\b": "What ... is",
    r"(?:^|(?<=[.!?] ))Of ": "a sentence that begins with Of",
}
NOT_PROSE = {".md": re.compile(r"\||#|    |>|!\["), ".txt": re.compile(r"  |---$|.*[Ee]xamples:$")}
CODE = re.compile(r"\.(cpp|hpp|py|sh|mjs|js|cmake|yaml|yml)$|(^|/)(CMakeLists\.txt|Snakefile|run)$")
NAMES = "kown,nd,fo"  # what codespell takes for mistakes
LEFT_OUT = ("docs/reference/", "tests/fuzz/corpus/")


def paragraphs(text, kind):
    """Returns (number of the first line, text) of each paragraph or item of a list in a .md or .txt, without tables and
    code."""
    found, is_code, is_new = [], False, True
    for number, line in enumerate(text.splitlines(), start=1):
        if line.lstrip().startswith("```"):
            is_code, is_new = not is_code, True
        elif is_code or not line.strip() or NOT_PROSE[kind].match(line):
            is_new = True
        else:
            item = re.match(r" *(?:[-*]|\d+\.) ", line)
            if is_new or item:
                found.append([number, ""])
            found[-1][1] += " " + line[item.end() if item else 0:].strip()
            is_new = False
    return [(number, plain(part).strip()) for number, part in found]


def plain(text):
    """Returns text with a sign for each code and the words of each link."""
    return re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", re.sub(r"`[^`]*`|\"[^\"]*\"", "@", text))


def wrong_sentences(name, text):
    """Returns what is wrong with the sentences of a page."""
    wrong = []
    for number, paragraph in paragraphs(text, pathlib.Path(name).suffix):
        for sentence in re.split(r"(?<=[.!?:;])\)?\s+", paragraph):
            count = len(re.findall(r"(?<!\S)[(*]*[A-Za-z]\S*", sentence))
            if count > MOST_WORDS:
                wrong.append(f"{name}:{number}: {count} words, expected at most {MOST_WORDS}: {sentence}")
        wrong += [f"{name}:{number}: says \"{what}\": {paragraph}" for pattern, what in BANNED.items()
                  if re.search(pattern, paragraph)]
    return wrong


def misspelt(files):
    """Returns what codespell says of files."""
    return subprocess.run(["codespell", "-L", NAMES, *files], cwd=ROOT, capture_output=True, text=True,
                          check=False).stdout.splitlines()


def main():
    files = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, check=True, capture_output=True,
                           text=True).stdout.split()
    ours = [file for file in files if not file.startswith(LEFT_OUT) and (ROOT / file).is_file()]
    pages = [file for file in ours if file.endswith(".md") or file.startswith("docs/help/")]
    wrong = [sentence for page in pages for sentence in wrong_sentences(page, (ROOT / page).read_text())]
    if shutil.which("codespell"):
        wrong += misspelt(pages + [file for file in ours if CODE.search(file)])
    else:
        print("spelling not checked: there is no codespell, scripts/setup.sh --checks installs it")
    print("\n".join([*wrong, f"{len(pages)} pages checked, {len(wrong)} wrong"]))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
