"""Races: two commands write to the same place; the result must be that of one after the other."""

import time

import fixtures
import folders
import program
import writers

NAME = "race"
# Command lines whose first half differs; a name of writers.py stands for its command, twice.
PAIRS = {
    **{f"{name}, twice": (line, line) for name, line in writers.WRITERS.items() if name != "profile"},
    "score of two methods": (writers.WRITERS["score"], writers.WRITERS["score"].replace("one", "two")),
    "run with two settings": ("run data --config config.json --threads 1 --out out",
                              "run data --config other.json --threads 1 --out out"),
    "bless of two runs": ("bless three baseline --even-if", "bless three_others baseline --even-if"),
    "report and bless": ("report run -o old.html --scans none", "bless run baseline --even-if"),
    "report of two runs": ("report run -o old.html", "report other_run -o old.html"),
    "run and score": ("run data --config config.json --threads 1 --out out", writers.WRITERS["score"]),
}


def _tree(bench):
    other = writers.three_sequences(bench.trees["delayed_run"])
    return writers.tree_of(bench.trees) | folders.at("three_others", other)


def prepare(bench):
    """What each pair leaves when its commands run one after the other, in both orders; a refused one writes nothing."""
    bench.orders = {}
    for name, pair in PAIRS.items():
        orders = []
        for lines in (pair, pair[::-1], pair[:1], pair[1:]):
            bench.renew(_tree(bench))
            codes = [bench.run(line).code for line in lines]
            if codes[0] not in (0, 1):
                raise fixtures.NotWhole(f"mosbench {lines[0]}: exit code {codes[0]}")
            orders.append(writers.contents(bench.case))
        bench.orders[name] = orders


def try_case(bench, random):
    name = random.choice(sorted(PAIRS))
    bench.renew(_tree(bench))
    first = program.start(bench.program, PAIRS[name][0].split(), bench.case)
    time.sleep(random.choice((0, 0, random.uniform(0, 0.02))))
    second_case = f"{bench.case}.second"
    second = program.start(bench.program, PAIRS[name][1].split(), bench.case, streams=second_case)
    ended = [program.finish(first, bench.case), program.finish(second, second_case)]
    faults = [fault for each in ended if (fault := program.fault_of(each))]
    if not faults and all(each.code in (2, 3) for each in ended):
        faults.append(("damaged", f"both are refused: {ended[0].err.strip()[-200:]}"))
    if not faults:
        found = writers.contents(bench.case)
        if found not in bench.orders[name]:
            sentence = folders.difference(bench.orders[name][0], found)
            faults.append(("damaged", f"not as after one and the other: {sentence}"))
    return bench.tried(name, ended[1], faults, processes=2)
