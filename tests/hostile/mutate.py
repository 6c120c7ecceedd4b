"""Mutation driver: damages one input and runs one command on it."""

import os
import re

import fixtures
import folders
import inputs
import mutations
import oracle
import program

NAME = "mutate"


def prepare(bench):
    bench.renew({})
    bench.kinds = inputs.kinds(bench.trees, bench.published)
    bench.everything = inputs.everything(bench.trees)
    bench.lines = sorted({line for kind in bench.kinds for line in kind.commands})
    commands = sorted({line.split()[0] for line in bench.lines})
    bench.flags = sorted({flag for command in commands for flag in re.findall(r"--[a-z-]+", bench.run(f"{command} --help").out)})
    bench.pool = sorted({data for kind in bench.kinds for data in kind.tree.values()})
    for kind in bench.kinds:
        folders.renew(bench.case, kind.tree)
        ended = bench.run(kind.commands[0])
        faults = oracle.faults_of(ended, bench.case, ())
        if ended.code not in (0, 1) or faults:
            raise fixtures.NotWhole(
                f"{kind.name}: mosbench {kind.commands[0]}: exit code {ended.code}, {faults}: {ended.err}")


def _damaged_words(random, bench):
    """A command line with a few words or bytes changed."""
    words = random.choice(bench.lines).split()
    for _ in range(random.choice((1, 1, 2, 4))):
        at = random.randrange(len(words) + 1)
        word = random.choice(mutations.WORDS).replace(b"\0", b"")
        other = random.choice(bench.lines).split()
        change = random.randrange(6)
        if change == 0 and words:
            del words[at % len(words)]
        elif change == 1 and words:
            words[at % len(words)] = os.fsdecode(word)
        elif change == 2:
            words.insert(at, os.fsdecode(word))
        elif change == 3:
            words[at:at] = other[random.randrange(len(other)):][:2]
        elif change == 4:
            words.insert(at, random.choice(bench.flags))
        elif words:
            damaged = mutations.damage(random, os.fsencode(words[at % len(words)]), word)
            words[at % len(words)] = os.fsdecode(damaged.replace(b"\0", b"")[:2000])
    # A million scans are a legal wish, and the drivers have other things to do.
    return [word if not re.fullmatch(r"[\d.e+]{4,}", word) or words[i - 1] not in ("--scans", "--size") else "7"
            for i, word in enumerate(words)]


def _damaged_input(random, bench, kind):
    """Writes the tree of a kind with one of its files damaged."""
    folders.renew(bench.case, kind.tree)
    name = random.choice(sorted(name for name in kind.tree if kind.damaged.search(name)))
    if random.random() < 0.08:
        mutations.change_file(random, bench.case, name)
    else:
        data = mutations.damage(random, kind.tree[name], random.choice(bench.pool))
        folders.write(bench.case, {name: data})


def try_case(bench, random):
    """(kind, words, faults, processes)"""
    choice = random.randrange(len(bench.kinds) + 3)
    if choice < len(bench.kinds):
        kind = bench.kinds[choice]
        _damaged_input(random, bench, kind)
        words, name = random.choice(kind.commands).split(), kind.name
    else:
        folders.renew(bench.case, bench.everything)
        words, name = _damaged_words(random, bench), "command line"
    before = folders.leftovers(bench.case)
    ended = program.run(bench.program, words, bench.case)
    return bench.tried(name, ended, oracle.faults_of(ended, bench.case, before))
