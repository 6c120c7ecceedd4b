"""Every command of README.md and docs is typed, in order, each page in a clean folder, and prints what the page says."""

import concurrent.futures
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = pathlib.Path(sys.argv.pop()).resolve()
PAGES = ["README.md", *sorted(str(page.relative_to(ROOT)) for page in (ROOT / "docs").rglob("*.md")
                              if "history" not in page.parts)]
# Makes what a page speaks of and a reader has.
STAND_INS = {
    "docs/formats/predictions.md": """
        mosbench simulate --layout semantickitti --scene room --scans 8 --seed 1 --out DATA
        mosbench run DATA --out DIR""",
    "docs/studies/answers.md": """
        mosbench simulate --layout doals --scene room --scans 6 --seed 1 --out DIR
        mv DIR/room DIR/station
        mosbench simulate --layout helimos --scene room --scans 6 --seed 1 --out DATA
        mosbench run DATA --out results/runs/helimos
        mosbench score DATA --predictions results/runs/helimos --method 4DMOS --out results/runs/4dmos
        mosbench simulate --layout semantickitti --scene street --scans 12 --seed 1 --out sim/street
        mosbench run sim/street --out results/runs/street
        mosbench simulate --layout semantickitti --scene room --scans 12 --seed 1 --out kitti
        mkdir -p ~/kitti/sequences; mv kitti/sequences/08 ~/kitti/sequences/04
        mosbench run ~/kitti/sequences/04 --odometry simple --out results/runs/04
        for file in simple.txt kiss.txt truth.txt; do cp ~/kitti/sequences/04/poses.txt $file; done""",
    "docs/studies/statistics.md": """
        mosbench simulate --layout semantickitti --scene room --scans 12 --seed 1 --out sim/room
        mosbench run sim/room --out RUN
        mosbench run sim/room --method dynablox --out OTHER""",
}
OWN_TESTS = {"docs/own_drive.md"}  # pages that another test types
# Are not typed: they install packages and compile, as scripts/check/fresh.sh does, or need a cluster.
UNTYPED = ("scripts/", "/usr/bin/python3 -m venv", "~/mosbench-venv/", "mosbench run results/studies/robustness.yaml --on slurm")


def blocks(text):
    """Returns [command, lines it prints] in the order of a page, from its blocks of shell commands."""
    commands = []
    for kind, block in re.findall(r"^```(\w*)\n(.*?)^```", text, re.MULTILINE | re.DOTALL):
        for line in filter(None, block.splitlines() if kind in ("", "sh") else []):
            if line.startswith("#"):
                commands[-1][1].append(line[1:].strip())
            else:
                commands.append([line, []])
    return commands


def spans(text):
    """Returns the command lines within the sentences of a page."""
    return re.findall(r"`(mosbench [^`]+)`", re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE))


def is_same(expected, word):
    """Whether words are equal, decimal numbers to the last digit that the page shows."""
    if re.fullmatch(r"-?\d+\.\d+", expected) and re.fullmatch(r"-?\d+\.\d+", word):
        return abs(float(expected) - float(word)) < 1.01 * 10 ** -len(expected.split(".")[1])
    return expected == word


def shows(line, expected):
    """Whether a printed line has the words that a page, which may leave out some, expects, in this order."""
    words = iter(line.split())
    return all(any(is_same(part, word) for word in words) for part in expected.split())


def unprinted(printed, expected):
    """Returns the expected lines that are not printed in this order."""
    lines = iter(printed.splitlines())
    return [part for part in expected if not any(shows(line, part) for line in lines)]


def unknown_words(command):
    """Returns the command of the program that does not exist, or its flags that help does not list."""
    words = re.sub(r'"[^"]*"|\'[^\']*\'|(^|\s)#.*', " ", command).split()
    if words[:1] != ["mosbench"] or words[1:2] in ([], ["COMMAND"]) or words[1].startswith("-"):
        return []
    done = subprocess.run([PROGRAM, words[1], "--help-all"], capture_output=True, text=True, check=False)
    if done.returncode:
        return [words[1]]
    flags = {word.split("=")[0] for word in words[2:] if re.match(r"--?[a-z]", word)}
    return sorted(flag for flag in flags if not re.search(rf"(?<![\w-]){re.escape(flag)}(?![\w-])", done.stdout))


def typed(page, commands):
    """Types commands in a clean folder and returns what each prints; raises at the first that fails."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        shutil.copytree(ROOT / "results", folder / "results", ignore=shutil.ignore_patterns("runs"))
        (folder / "build/release/eval").mkdir(parents=True)
        (folder / "build/release/eval/mosbench").symlink_to(PROGRAM)
        script = "\n".join(["set -e", STAND_INS.get(page, ""), *(f"printf '\\001'\n{command}" for command in commands)])
        environment = {**os.environ, "HOME": str(folder / "home")}
        if page != "README.md":  # which sets it
            environment["PATH"] = f"{PROGRAM.parent}:{environment['PATH']}"
        done = subprocess.run(["bash", "-c", script], cwd=folder, env=environment, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, check=False)
    stand_in, *answers = done.stdout.split("\001")
    if done.returncode:
        raise AssertionError(f"{page}: {commands[len(answers) - 1] if answers else 'its stand-in'}: exit code "
                             f"{done.returncode}\n{(answers or [stand_in])[-1]}")
    return answers


def wrong_output(page, text):
    """Types what can be typed of a page and returns sentences about lines that are not printed."""
    commands = [pair for pair in blocks(text) if not pair[0].startswith(UNTYPED)]
    answers = typed(page, [command for command, _ in commands]) if commands else []
    return [f"{page}: {command}: does not print: {line}" for (command, lines), answer in zip(commands, answers)
            for line in unprinted(answer, lines)]


class Manual(unittest.TestCase):
    def test_commands_have_the_flags_that_pages_name(self):
        found = 0
        for page in PAGES:
            text = (ROOT / page).read_text()
            for command in [command for command, _ in blocks(text)] + spans(text):
                found += command.startswith("mosbench ")
                self.assertEqual(unknown_words(command), [], f"{page}: {command}")
        self.assertGreater(found, 40)

    def test_scripts_of_pages_are_there(self):
        for page in PAGES:
            for command, _ in blocks((ROOT / page).read_text()):
                if command.startswith("scripts/"):
                    self.assertTrue(os.access(ROOT / command.split()[0], os.X_OK), f"{page}: {command}")

    def test_commands_in_blocks_print_what_pages_say(self):
        typed_pages = [page for page in PAGES if page not in OWN_TESTS]
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            for wrong in pool.map(lambda page: wrong_output(page, (ROOT / page).read_text()), typed_pages):
                self.assertEqual(wrong, [])


    @unittest.skipIf(subprocess.run(["/usr/bin/python3", "-c", "import numpy"], capture_output=True, check=False).returncode,
                     "the program of the study needs numpy")
    def test_the_study_of_its_page_is_planned(self):
        page = "docs/studies/study.md"
        (study,) = re.findall(r"^```yaml\n(.*?)^```", (ROOT / page).read_text(), re.MULTILINE | re.DOTALL)
        study = study.replace("python3 /home/me/my_network.py", f"/usr/bin/python3 {ROOT}/tests/examples/exec/client.py")
        answer = typed(page, ["mosbench simulate --layout semantickitti --scene room --scans 8 --seed 1 --out kitti",
                              "mkdir -p ~/kitti/sequences; mv kitti/sequences/08 ~/kitti/sequences",
                              f"cat >mine.yaml <<'END'\n{study}END", "mosbench run mine.yaml --dry-run"])[-1]
        self.assertRegex(answer, r"\n2076 cells: 0 done, 2076 missing, 0 failed")


class Mistakes(unittest.TestCase):
    def test_a_wrong_flag_and_a_wrong_command_are_named(self):
        self.assertEqual(unknown_words('mosbench rank DIR --best-of --as latex -o "a --b" # --why'), ["--best-of"])
        self.assertEqual(unknown_words("mosbench rnk DIR"), ["rnk"])
        with self.assertRaisesRegex(AssertionError, "README.md: mosbench rank --best-of: exit code 2\n(.|\n)*--best-of"):
            wrong_output("README.md", f"```\nexport PATH={PROGRAM.parent}:$PATH\nmosbench rank --best-of\n```\n")

    def test_a_wrong_line_is_named(self):
        page = "```text\n# no command\n```\n```\nprintf 'a 1.23 of 20 m\\nb 3\\n'   # why\n#   a  1.2{} m\n#   b {}\n```\n"
        for last, whole in ((3, 3), (4, 3)):
            self.assertEqual(wrong_output("", page.format(last, whole)), [])
        for last, whole, line in ((5, 3, "a  1.25 m"), (3, 4, "b 4")):
            self.assertEqual(len(wrong_output("", page.format(last, whole))), 1 if whole == 4 else 2)
            self.assertIn(f"does not print: {line}", wrong_output("", page.format(last, whole))[0])


if __name__ == "__main__":
    unittest.main()
