#!/usr/bin/env python3
"""Does every plausible bug of tests/mutants turn a test red?

mutants.py [--only WORD] [--again] [--jobs N]   builds each in a copy of the sources, and runs tests until one fails
mutants.py --check                              only: does every patch still apply?

tests/mutants/README.md says what a patch holds. Kills are kept in build/mutants until a source of the room changes, so
that an interrupted run goes on where it ended, and a survivor is tried again with new tests; --again forgets them.
"""

import argparse
import collections
import functools
import hashlib
import json
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
PATCHES = ROOT / "tests/mutants"
WORK = ROOT / "build/mutants"
# The build folder lies in the copy as it does in a clone, so that ccache knows what a clone has compiled.
SOURCE, BUILD, RESULTS = WORK / "source", WORK / "source/build/release", WORK / "results.json"
FOLDERS = ("core", "datasets", "eval", "tests", "results", "scripts")
# Each may use those before it.
ROOMS = ("core", "datasets", "eval")
KILLED_BY = re.compile(r"^Killed by: (\S+) (\S+)$\n?", re.MULTILINE)
# The tests of the Python package, as if they were a program.
PYTHON = "tests/python"
# The programs that matter for a folder, those that find most bugs in the least time first.
PROGRAMS = {
    "eval/python": (PYTHON,),
    "core": ("tests_unit_core", "tests_differential_core"),
    "datasets": ("tests_unit_datasets", "tests_property"),
    "eval": ("tests_unit_eval", "tests_property", "tests_differential"),
}
EVERY_TEST = "*"
# An exit code of pytest; Google Test exits with 0 then.
PYTEST_SELECTED_NOTHING = 5
# A loop without end is a killed mutant, too. CPU time, which a busy machine does not change.
LIMIT_CPU_S, LIMIT_OF_ONE_TEST_CPU_S = 300, 60
OPTIONS = ("MOSBENCH_WITH_PCL=OFF", "MOSBENCH_WITH_ROSBAG=OFF", "MOSBENCH_BUILD_BENCH=OFF",
           "MOSBENCH_WARNINGS_AS_ERRORS=ON",
           # A mutant changes one file.
           "MOSBENCH_FILES_AT_A_TIME=1",
           # A test program that was just linked is not run for the names of its tests.
           "CMAKE_GTEST_DISCOVER_TESTS_DISCOVERY_MODE=PRE_TEST")


def git(*words, folder=ROOT):
    """Runs git as if `folder` were no part of a repository, so that it applies patches there."""
    environment = {**os.environ, "GIT_CEILING_DIRECTORIES": str(WORK)}
    return subprocess.run(["git", *words], cwd=folder, env=environment, capture_output=True, text=True, check=False)


def sources():
    """Names of all files that the copy holds."""
    listed = git("ls-files", "--cached", "--others", "--exclude-standard").stdout.splitlines()
    return [name for name in listed if "/" not in name or name.split("/")[0] in FOLDERS]


def copy_sources():
    """Makes the copy equal to the sources; a file that is equal keeps its time, so that it is not built again."""
    names = set(sources())
    for file in SOURCE.rglob("*"):
        name = str(file.relative_to(SOURCE))
        if file.is_file() and name not in names and not name.startswith("build/"):
            file.unlink()
    for name in names:
        here, there = ROOT / name, SOURCE / name
        if here.is_file() and not (there.is_file() and there.read_bytes() == here.read_bytes()):
            there.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(here, there)
            os.utime(there)


@functools.cache
def state_of(room):
    """Of the sources that a room's program holds, without tests: whom one has killed stays dead when there are more."""
    state = hashlib.sha256()
    others = tuple(f"{name}/" for name in (*ROOMS[ROOMS.index(room) + 1:], "tests", "bench"))
    for name in sorted(sources()):
        if re.search(r"\.(cpp|hpp|txt|cmake)$", name) and not name.startswith(others):
            state.update(name.encode() + (ROOT / name).read_bytes())
    return state.hexdigest()


def reason_of(patch):
    return KILLED_BY.sub("", patch.read_text().partition("diff --git")[0]).strip()


def named_test_of(patch):
    """(program, test) that killed it before, as the patch says; nothing when it does not."""
    return [found.groups() for found in KILLED_BY.finditer(patch.read_text())][:1]


def file_of(patch):
    return re.search(r"^\+\+\+ b/(\S+)", patch.read_text(), re.MULTILINE).group(1)


def faults_of(patch):
    """What is wrong with a patch before it is built."""
    faults = []
    if not reason_of(patch):
        faults.append("no reason above the diff")
    answer = git("apply", "-C1", "--check", patch)
    if answer.returncode != 0:
        faults.append(f"does not apply: {answer.stderr.strip()}")
    return faults


def programs_of(patch):
    return next(programs for folder, programs in PROGRAMS.items() if file_of(patch).startswith(folder + "/"))


def build(program, jobs):
    """What the compiler says when the program does not build; None when it does."""
    environment = {"CCACHE_BASEDIR": str(SOURCE), "CCACHE_NOHASHDIR": "true", **os.environ}
    target = "mosbench_python" if program == PYTHON else program
    built = subprocess.run(["cmake", "--build", BUILD, "-j", str(jobs), "--target", target],
                           env=environment, capture_output=True, text=True, check=False)
    return built.stdout[-2000:] if built.returncode != 0 else None


def configure():
    launcher = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
    subprocess.run(["cmake", "--preset", "release", *(f"-D{option}" for option in OPTIONS), *launcher],
                   cwd=SOURCE, check=True, stdout=subprocess.DEVNULL)


def cpu_s_of(pid):
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def python_of_package():
    return re.search(r"^Python3_EXECUTABLE:\w+=(.*)$", (BUILD / "CMakeCache.txt").read_text(), re.MULTILINE).group(1)


def words_of(program, choice):
    """The command that runs the tests of a choice, which is a filter of Google Test."""
    if program != PYTHON:
        return [BUILD / "tests" / program, "--gtest_color=no", "--gtest_fail_fast", f"--gtest_filter={choice}"]
    wanted, _, unwanted = choice.partition("-")
    names = [] if wanted == EVERY_TEST else ["(" + " or ".join(wanted.split(":")) + ")"]
    names += [f"not {name}" for name in unwanted.split(":") if name]
    return [python_of_package(), "-m", "pytest", "-q", "-x", "--color=no", "-p", "no:cacheprovider",
            "--basetemp", BUILD / "pytest", "-k", " and ".join(names), SOURCE / PYTHON]


def run_tests(program, choice):
    """(exit code, output). The kernel's limit of CPU time would make the clock of CPU time coarse, which tests read."""
    is_one = not set(choice) & set(":*-")
    limit_s = LIMIT_OF_ONE_TEST_CPU_S if is_one else LIMIT_CPU_S
    environment = {**os.environ, "PYTHONPATH": str(BUILD / "python"), "PYTHONDONTWRITEBYTECODE": "1",
                   "MOSBENCH_BINARY_DIR": str(BUILD)}
    process = subprocess.Popen(words_of(program, choice), cwd=BUILD, env=environment, stdout=subprocess.PIPE,
                               stderr=subprocess.DEVNULL, text=True)
    while True:
        try:
            output, _ = process.communicate(timeout=5)
            no_such_test = program == PYTHON and process.returncode == PYTEST_SELECTED_NOTHING
            return 0 if no_such_test else process.returncode, output
        except subprocess.TimeoutExpired:
            if cpu_s_of(process.pid) > limit_s:
                process.kill()


def failed_test(output):
    """The first test that failed, or the one in which the program ended."""
    patterns = (r"\[  FAILED  \] ([^\s,]+)", r"^(?:FAILED|ERROR) \S+::(\w+)", r"(?s:.*)\[ RUN      \] (\S+)")
    found = (re.search(pattern, output, re.MULTILINE) for pattern in patterns)
    return next((one.group(1) for one in found if one), None)


def killer_of(program, choice, unsteady=""):
    """The test that fails, twice, or None when all pass; a busy machine may fail one that measures time."""
    code, output = run_tests(program, f"{choice}-{unsteady}" if unsteady else choice)
    if code == 0:
        return None
    failed = failed_test(output)
    if failed and run_tests(program, failed)[0] == 0:
        return killer_of(program, choice, f"{unsteady}:{failed}")
    return failed or choice


def verdict_of(patch, jobs):
    """(verdict, program and test that killed it, or what went wrong)"""
    if git("apply", "-C1", patch, folder=SOURCE).returncode != 0:
        return "does not apply", ""
    try:
        for program, choice in [*named_test_of(patch), *((each, EVERY_TEST) for each in programs_of(patch))]:
            if complaint := build(program, jobs):
                return "does not build", complaint
            if killer := killer_of(program, choice):
                return "killed", f"{program} {killer}"
        return "survived", ""
    finally:
        git("apply", "-C1", "-R", patch, folder=SOURCE)


def check_the_unchanged(killers, jobs):
    """Tests that fail without any mutant prove nothing."""
    choices = collections.defaultdict(set)
    for killer in killers:
        program, test = killer.split(" ")
        choices[program].add(test)
    for program, tests in choices.items():
        if complaint := build(program, jobs):
            sys.exit(f"{program} does not build:\n{complaint}")
        if killer := killer_of(program, ":".join(sorted(tests))):
            sys.exit(f"{program} {killer} fails without any mutant")


def bug_of(patch):
    """A patch without the test that killed it before, in these sources."""
    text = KILLED_BY.sub("", patch.read_text()) + state_of(file_of(patch).split("/")[0])
    return f"{patch.stem} {hashlib.sha256(text.encode()).hexdigest()[:8]}"


def load_kills(again):
    return json.loads(RESULTS.read_text()) if RESULTS.is_file() and not again else {}


def cpu_min():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return (used.ru_utime + used.ru_stime) / 60


def judge_all(patches, arguments):
    start, killers, verdicts = time.monotonic(), set(), collections.Counter()
    kills = load_kills(arguments.again)
    copy_sources()
    configure()
    for patch in sorted(patches, key=lambda patch: (file_of(patch), patch.name)):
        bug = bug_of(patch)
        verdict, detail = ("killed", kills[bug]) if bug in kills else verdict_of(patch, arguments.jobs)
        if verdict == "killed":
            kills[bug] = detail
            killers.add(detail)
            RESULTS.write_text(json.dumps(kills, indent=1))
        verdicts[verdict] += 1
        print(f"{patch.stem}: {verdict}{': ' * bool(detail)}{detail}", flush=True)
    check_the_unchanged(killers, arguments.jobs)
    print(f"{len(patches)} mutants in {(time.monotonic() - start) / 60:.0f} min, {cpu_min():.0f} CPU min: " + ", ".join(
        f"{verdicts[each]} {each}" for each in ("killed", "survived", "does not apply", "does not build")))
    return 0 if verdicts["killed"] == len(patches) else 1


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="only whether every patch applies")
    parser.add_argument("--only", default="", metavar="WORD", help="patches with this in their name")
    parser.add_argument("--again", action="store_true", help="forget earlier results")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), metavar="N", help="compilers that run")
    arguments = parser.parse_args()
    patches = sorted(patch for patch in PATCHES.glob("*.patch") if arguments.only in patch.name)
    faults = [f"{patch.name}: {fault}" for patch in patches for fault in faults_of(patch)]
    print("\n".join([*faults, f"{len(patches)} mutants, {len(faults)} with a fault"]))
    if faults or not patches:
        return 1
    return 0 if arguments.check else judge_all(patches, arguments)


if __name__ == "__main__":
    sys.exit(main())
