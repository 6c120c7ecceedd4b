"""Starts the program under test and says how it ended."""

import os
import re
import resource
import select
import subprocess
import time
from dataclasses import dataclass

# CPU time, since a busy machine lets a process wait; and in any case.
LIMIT_CPU_S = 60
LIMIT_S = 600
# A process that sleeps this long without using the CPU waits for something that never comes.
IDLE_S = 5
TICKS_PER_S = os.sysconf("SC_CLK_TCK")
MOST_OUTPUT_BYTES = 1 << 20
ENVIRONMENT = {
    "PATH": "/usr/bin:/bin",
    "LC_ALL": "C.UTF-8",
    "ASAN_OPTIONS": "detect_leaks=0",
}
SANITIZER = re.compile(r"ERROR: \w*Sanitizer|WARNING: ThreadSanitizer|runtime error:")
DOCUMENTED = {0, 1, 2, 3}
# Commands whose finding can be bad.
MAY_FIND = {"compare", "doctor", "odometry", "rank"}


@dataclass(frozen=True)
class Ended:
    """How a process ended; `code` is negative for the signal that ended it."""

    words: list
    code: int
    hung: bool
    out: str
    err: str


def limit_this_process(program):
    """Keeps children of this process from eating the machine: no core files, 1 GiB files, 4 GiB of memory."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 30, resource.RLIM_INFINITY))
    # A sanitizer maps terabytes that it does not use.
    if not re.search(rb"__[at]san_init", program.read_bytes()):
        resource.setrlimit(resource.RLIMIT_AS, (4 << 30, resource.RLIM_INFINITY))


def start(program, words, case, prepare=None, out=None, streams=None):
    """Starts `program words...` in the folder of a case; its streams go to files next to that folder."""
    streams = streams or case
    with open(f"{streams}.err", "wb") as err, open(f"{streams}.out", "wb") as own:
        return subprocess.Popen(
            [program, *words], cwd=case, env=ENVIRONMENT, stdin=subprocess.DEVNULL, stderr=err,
            stdout=own if out is None else out, preexec_fn=prepare,
        )


def _state_and_ticks(pid):
    """The state of a process and the CPU time that it has used."""
    try:
        with open(f"/proc/{pid}/stat", "rb") as file:
            fields = file.read().rpartition(b")")[2].split()
    except OSError:
        return b"Z", -1
    return fields[0], int(fields[11]) + int(fields[12])


def ends_in_time(process):
    """Waits for the end of a process; kills one that hangs and returns False."""
    deadline = time.monotonic() + LIMIT_S
    ticks_before = None
    descriptor = os.pidfd_open(process.pid)
    try:
        waiting = select.poll()
        waiting.register(descriptor, select.POLLIN)
        while not waiting.poll(1000 * IDLE_S):
            state, ticks = _state_and_ticks(process.pid)
            is_asleep = state == b"S" and ticks == ticks_before
            if is_asleep or ticks > LIMIT_CPU_S * TICKS_PER_S or time.monotonic() > deadline:
                process.kill()
                process.wait()
                return False
            ticks_before = ticks
    finally:
        os.close(descriptor)
    process.wait()
    return True


def _text(path):
    with open(path, "rb") as file:
        return file.read(MOST_OUTPUT_BYTES).decode(errors="replace")


def finish(process, streams):
    """Waits for a process that `start` started and returns how it ended."""
    in_time = ends_in_time(process)
    out, err = _text(f"{streams}.out"), _text(f"{streams}.err")
    return Ended(process.args[1:], process.returncode, not in_time, out, err)


def run(program, words, case, streams=None, **how):
    return finish(start(program, words, case, streams=streams, **how), streams or case)


def fault_of(ended):
    """(column, sentence) when a process ended as none may; None otherwise."""
    if ended.hung:
        return "hangs", f"no end within {LIMIT_CPU_S} s of CPU time, or asleep without end"
    if match := SANITIZER.search(ended.err):
        return "crashes", match.group()
    if ended.code < 0:
        return "crashes", f"signal {-ended.code}"
    command = ended.words[0] if ended.words else ""
    if ended.code not in DOCUMENTED or (ended.code == 1 and command not in MAY_FIND):
        return "crashes", f"exit code {ended.code}: {ended.err.strip()[-200:]}"
    if ended.code in (2, 3) and not (ended.err + ended.out).strip():
        return "crashes", f"exit code {ended.code} without a message"
    return None
