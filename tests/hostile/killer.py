"""Killer: SIGKILL at a random moment, then the same command again."""

import time

import folders
import program
import writers

NAME = "kill"


def prepare(bench):
    bench.writers = writers.measure(bench)


def aftermath(bench, writer, faults):
    """Adds what is wrong after a disturbed command: now, and once the same command ran undisturbed."""
    left = writers.contents(bench.case)
    if sentence := writers.half_written(writer, left):
        faults.append(("damaged", sentence))
    # convert refuses to write over a data set that is whole.
    is_whole = writer.words[0] == "convert" and left == writer.after
    again = program.run(bench.program, writer.words, bench.case)
    if fault := program.fault_of(again):
        faults.append((fault[0], f"the same command again: {fault[1]}"))
    elif again.code not in ((2,) if is_whole else (0, 1)):
        faults.append(("damaged", f"the same command again is refused: {again.err.strip()[-300:]}"))
    elif sentence := folders.difference(writer.after, writers.contents(bench.case)):
        faults.append(("damaged", f"after the same command again {sentence}"))
    return again


def try_case(bench, random):
    writer = random.choice(bench.writers)
    bench.renew(writers.tree_of(bench.trees))
    moment_s = random.uniform(0.2, 1.1) * writer.seconds
    process = program.start(bench.program, writer.words, bench.case)
    time.sleep(moment_s)
    process.kill()
    process.wait()
    hit = process.returncode < 0
    # The duration follows how busy the machine is, so that most kills hit.
    writer.seconds *= 1.01 if hit else 0.98
    faults = []
    again = aftermath(bench, writer, faults)
    return bench.tried(writer.name, again, faults, processes=2, hit=hit)
