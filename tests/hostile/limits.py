"""Limits: a full disk, small limits, closed streams, folders that cannot be written."""

import dataclasses
import os
import resource
import shutil

import folders
import killer
import program
import writers

NAME = "limit"


def prepare(bench):
    """Needs the writers that the killer has measured."""


def _limited(kind, amount):
    def prepare():
        resource.setrlimit(kind, (amount, amount))
    return prepare


def _closed(*streams):
    def prepare():
        for stream in streams:
            os.close(stream)
    return prepare


def _broken_pipe():
    reading, writing = os.pipe()
    os.close(reading)
    return writing


def _with_folders_read_only(bench, writer):
    tops = [bench.case, *(entry.path for entry in os.scandir(bench.case) if entry.is_dir())]
    for folder in tops:
        os.chmod(folder, 0o555)
    try:
        return program.run(bench.program, writer.words, bench.case)
    finally:
        for folder in tops:
            os.chmod(folder, 0o755)


def _on_a_full_disk(bench, writer, room_bytes):
    """Runs the command on a small file system of this process alone that has some room left."""
    disk = f"{bench.small_disk}/case"
    shutil.copytree(bench.case, disk, symlinks=True)
    filler = f"{bench.small_disk}/filler"
    free = os.statvfs(bench.small_disk)
    with open(filler, "wb") as file:
        file.truncate(0)
        os.posix_fallocate(file.fileno(), 0, max(1, free.f_bavail * free.f_bsize - room_bytes))
    ended = program.run(bench.program, writer.words, disk, streams=bench.case)
    os.remove(filler)
    shutil.rmtree(bench.case)
    shutil.copytree(disk, bench.case, symlinks=True)
    shutil.rmtree(disk)
    return ended


def _choose(bench, random):
    """(name, function that runs a writer so)"""
    def under(prepare=None, out=None):
        return lambda writer: program.run(bench.program, writer.words, bench.case, prepare=prepare, out=out)

    choices = {
        "file size": under(_limited(resource.RLIMIT_FSIZE, random.choice((0, 1, 100, 1000, 4096, 10_000, 50_000, 600_000)))),
        "memory": under(_limited(resource.RLIMIT_AS, random.randrange(12, 120) << 20)),
        "open files": under(_limited(resource.RLIMIT_NOFILE, random.randrange(3, 12))),
        "threads": under(_limited(resource.RLIMIT_NPROC, 0)),
        "stdout closed": under(_closed(1)),
        "all streams closed": under(_closed(0, 1, 2)),
        "stdout full": under(out=bench.full_device),
        "read-only folders": lambda writer: _with_folders_read_only(bench, writer),
    }
    if bench.small_disk:
        room_bytes = random.choice((0, 4096, 8192, 20_000, 40_000, 100_000))
        choices["full disk"] = lambda writer: _on_a_full_disk(bench, writer, room_bytes)
    name = random.choice([*choices, "stdout broken"])
    if name == "stdout broken":
        return name, under(out=_broken_pipe())
    return name, choices[name]


def _excused(name, ended, run, writer):
    """The loader, not the program, may find too little memory; and a message needs somewhere to go."""
    if name in ("file size", "all streams closed") and ended.code == 3 and not ended.err:
        return True
    # A library that finds no memory before main ends whatever the program is asked for.
    if name == "memory" and ended.code == -6 and "std::bad_alloc" in ended.err:
        return run(dataclasses.replace(writer, words=["--version"])).code == -6
    return name in ("memory", "open files") and ended.code == 127 and "shared libraries" in ended.err


def try_case(bench, random):
    name, run = _choose(bench, random)
    writer = random.choice(bench.writers)
    bench.renew(writers.tree_of(bench.trees))
    ended = run(writer)
    faults = []
    if not _excused(name, ended, run, writer) and (fault := program.fault_of(ended)):
        faults.append(fault)
    # Who may open no file cannot look into a folder to remove it; the same command again does.
    if name != "open files" and (left := folders.leftovers(bench.case)):
        faults.append(("damaged", f"left behind: {', '.join(left[:3])}"))
    killer.aftermath(bench, writer, faults)
    return bench.tried(f"{name}: {writer.name}", ended, faults, processes=2)
