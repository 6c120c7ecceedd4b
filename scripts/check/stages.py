#!/usr/bin/env python3
"""Compares the CPU time of each stage's micro-benchmark with the same stage inside the pipeline.

    scripts/check/stages.py build/release/bench/mosbench_bench [--repetitions 9] [--within 10]
        [-- --data FOLDER]

Both are measured in one process, in random order; medians over the repetitions are compared. Exit
code 1 when a stage that takes at least one per cent of the pipeline's time differs by more, or when
nothing was there to compare.
"""

import argparse
import json
import statistics
import subprocess
import sys


def measure(program, repetitions, arguments):
    """CPU milliseconds of every repetition: {(benchmark, workload, threads): [runs]}."""
    command = [program, "--benchmark_format=json", "--benchmark_min_time=0.05",
               f"--benchmark_repetitions={repetitions}",
               "--benchmark_enable_random_interleaving=true", *arguments]
    answer = subprocess.run(command, stdout=subprocess.PIPE, check=False)
    if answer.returncode != 0:
        sys.exit(f"stages.py: {program}: exit code {answer.returncode}")
    runs = {}
    for run in json.loads(answer.stdout)["benchmarks"]:
        if run["run_type"] != "iteration" or "error_message" in run:
            continue
        stage, workload, threads = run["name"].split("/")[:3]
        runs.setdefault((stage, workload, threads), []).append(run)
    return runs


def median_of(runs, value):
    return statistics.median(run[value] for run in runs)


def compare(runs, within):
    """Prints a line for each stage. Returns how many were compared, and how many of weight differ by
    more than `within` per cent."""
    compared = differing = 0
    for (name, workload, threads), of_pipeline in sorted(runs.items()):
        if name != "pipeline":
            continue
        stages = [key.removesuffix("_cpu_ms") for key in of_pipeline[0] if key.endswith("_cpu_ms")]
        in_pipeline = {stage: median_of(of_pipeline, f"{stage}_cpu_ms") for stage in stages}
        for stage, ms in in_pipeline.items():
            of_stage = runs.get((stage, workload, threads))
            if of_stage is None or ms == 0:
                continue
            alone_ms = median_of(of_stage, "cpu_time")
            share, ratio = ms / sum(in_pipeline.values()), alone_ms / ms
            differs = share >= 0.01 and abs(ratio - 1) * 100 > within
            compared += 1
            differing += differs
            print(f"{workload:9} {threads:9} {stage:15} {ms:8.3f} ms in the pipeline, "
                  f"{alone_ms:8.3f} ms alone, ratio {ratio:5.2f}, {share:4.0%} of the time"
                  f"{'  DIFFERS' if differs else ''}", flush=True)
    return compared, differing


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="mosbench_bench")
    parser.add_argument("--repetitions", type=int, default=9)
    parser.add_argument("--within", type=float, default=10, help="per cent")
    parser.add_argument("arguments", nargs="*", help="further ones for mosbench_bench, after --")
    options = parser.parse_intermixed_args()
    compared, differing = compare(
        measure(options.program, options.repetitions, options.arguments), options.within)
    print(f"{compared} stages compared, {differing} differ by more than {options.within:g} %")
    return 1 if differing or not compared else 0


if __name__ == "__main__":
    sys.exit(main())
