#!/usr/bin/env python3
"""Compiles every header of the rooms alone: each must include all that it needs.

Most of that time is spent in headers of others, such as Eigen's. What many of ours include, themselves or through one
another, is compiled once before, and brought only to those that include all of it. That hides nothing, because what a
header says comes after its includes, which is checked as well."""

import collections
import concurrent.futures
import functools
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = ("core", "datasets", "eval")
# Need packages that are installed only where these are built.
LEFT_OUT = ("core/include/mosbench/pcl.hpp", "eval/python/")
# Vectors are returned by functions that are always inlined: no calling convention is involved.
COMPILE = ["c++", "-std=c++20", "-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wconversion", "-Wsign-conversion",
           "-Wold-style-cast", "-Wno-psabi", "-Werror", "-I.", "-Icore/include"]
INCLUDE = re.compile(r'#include ([<"])([^>"]+)[>"]')
# All that may come before an include.
COMMENT_OR_CONDITION = re.compile(r"(//.*|#.*|)$")
# What takes long in the compiler, beside the libraries, whose names have a slash.
LONG_STANDARD_HEADERS = {"filesystem", "string"}
# What fewer headers share is not worth a compilation of its own.
MANY = 4


def headers():
    listed = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard",
                             *(f"{folder}/*.hpp" for folder in FOLDERS)],
                            cwd=ROOT, check=True, capture_output=True, text=True).stdout.split()
    return [name for name in listed if not name.startswith(LEFT_OUT)]


@functools.cache
def foreign(header):
    """Headers of others that a header includes, itself or through ours."""
    found = set()
    for quote, name in INCLUDE.findall((ROOT / header).read_text()):
        if quote == "<" and not name.startswith("mosbench/"):
            found.add(name)
        else:
            found |= foreign(name if quote == '"' else f"core/include/{name}")
    return frozenset(found)


def shared_sets(names):
    """What all of these headers include that include the same of what takes long."""
    groups = collections.defaultdict(list)
    for header in names:
        long = frozenset(name for name in foreign(header) if "/" in name or name in LONG_STANDARD_HEADERS)
        groups[long].append(foreign(header))
    return [frozenset.intersection(*group) for long, group in groups.items() if long and len(group) >= MANY]


@functools.cache
def eigen_flags():
    done = subprocess.run(["pkg-config", "--cflags", "eigen3"], check=True, capture_output=True, text=True)
    return shlex.split(done.stdout.replace("-I", "-isystem "))


def compile_text(text, *arguments):
    """What the compiler says about it; nothing when it is right."""
    done = subprocess.run([*COMPILE, *eigen_flags(), *arguments], cwd=ROOT, input=text, capture_output=True, text=True)
    return done.stderr if done.returncode != 0 else ""


def precompile(names, path):
    """Makes path, which includes these headers, and path.gch; returns what is needed to use it."""
    path.write_text("".join(f"#include <{name}>\n" for name in sorted(names)))
    if wrong := compile_text("", "-x", "c++-header", str(path)):
        raise SystemExit(wrong)
    return names, path


def largest(precompiled, header):
    """Arguments that bring the most of what a header includes, and nothing else."""
    fitting = [path for names, path in precompiled if names <= foreign(header)]
    size = lambda path: path.with_name(path.name + ".gch").stat().st_size
    return ["-Winvalid-pch", "-include", str(max(fitting, key=size))] if fitting else []


def late_include(header):
    """Number of a line that includes after something else; None without such a line."""
    something_else = False
    for number, line in enumerate((ROOT / header).read_text().splitlines(), start=1):
        if something_else and INCLUDE.match(line):
            return number
        something_else = something_else or not COMMENT_OR_CONDITION.match(line)
    return None


def complaint(header, precompiled):
    if (line := late_include(header)) is not None:
        return f"{header}:{line}: an include after something else, expected it above\n"
    name = header.removeprefix("core/include/")
    return compile_text(f'#include "{name}"\n', *largest(precompiled, header), "-fsyntax-only", "-x", "c++", "-")


def main():
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as threads:
        names = headers()
        shared = shared_sets(names)
        paths = [pathlib.Path(folder) / f"{i}.hpp" for i in range(len(shared))]
        precompiled = list(threads.map(precompile, shared, paths))
        wrong = list(filter(None, threads.map(lambda header: complaint(header, precompiled), names)))
    print(*wrong, sep="", end="")
    print(f"{len(names)} headers compiled alone, {len(wrong)} wrong")
    return 1 if wrong or not names else 0


if __name__ == "__main__":
    sys.exit(main())
