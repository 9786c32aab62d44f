#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures the load that one agent causes while it carves: CPU time, wake-ups and memory.

    tests/bench/agent_load.py [SECONDS]     of the release build; others: KERF_SERVER, KERF_AGENT

A server on loopback, an agent with a simulated hand that carves its figure in a block of 60 mm at a
pitch of 0.25 mm. After 4 s, in which it arms and enters the stock, it reads /proc for SECONDS (10):
per thread the CPU time and the wake-ups (voluntary context switches), and the resident memory.
Before that, and after it, the same for an empty loop of 1 kHz (that of `kerf-agent doctor`): what
waking a thread costs on this machine, which no agent can save.
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
BINARIES = ROOT / "build" / "release" / "bin"
os.environ.setdefault("KERF_SERVER", str(BINARIES / "kerf-server"))
AGENT = os.environ.setdefault("KERF_AGENT", str(BINARIES / "kerf-agent"))
sys.path.insert(0, str(ROOT / "tests" / "server"))

from live_server import Server  # noqa: E402

SCENE = {
    "name": "load",
    "stock": {"shape": "box", "min_mm": [-30, -30, -20], "max_mm": [30, 30, 0]},
    "accuracy": {"rays": "dexel", "pitch_mm": 0.25, "tolerance_mm": 0.01, "motion": "tight"},
    "tools": [{"id": 1, "shape": "ball", "diameter_mm": 6, "length_mm": 40}],
    "force": {"law": "specific_energy", "specific_force_n_per_mm2": 0.2, "pivot_mm": 20},
}
WARM_UP_S = 4


def threads_of(pid):
    """Returns {thread: (CPU seconds, wake-ups)}."""
    threads = {}
    for task in pathlib.Path(f"/proc/{pid}/task").iterdir():
        seconds = int((task / "schedstat").read_text().split()[0]) * 1e-9
        status = dict(line.split(":\t", 1) for line in (task / "status").read_text().splitlines())
        threads[task.name] = (seconds, int(status["voluntary_ctxt_switches"]))
    return threads


def resident_mb(pid):
    status = pathlib.Path(f"/proc/{pid}/status").read_text()
    return int(status.split("VmRSS:")[1].split()[0]) / 1024


# Names of the threads by their real-time priority; the others are the main thread and its helpers.
ROLES = {"90": "watchdog", "80": "servo", "70": "replica", "60": "link"}


def role_of(pid, task):
    fields = pathlib.Path(f"/proc/{pid}/task/{task}/stat").read_text().rsplit(")", 1)[1].split()
    return ROLES.get(fields[37], "other")


def measure(pid, seconds):
    """Returns [(role, CPU %, wake-ups/s)] of the threads of a process."""
    before, start = threads_of(pid), time.monotonic()
    time.sleep(seconds)
    after, passed = threads_of(pid), time.monotonic() - start
    return [(role_of(pid, task), 100 * (cpu - before.get(task, (0, 0))[0]) / passed,
             (wakes - before.get(task, (0, 0))[1]) / passed)
            for task, (cpu, wakes) in sorted(after.items())]


def empty_loop(seconds):
    """Returns the CPU % of a thread of priority 80 that wakes at 1 kHz and does nothing."""
    doctor = subprocess.Popen([AGENT, "doctor", "--seconds", str(seconds + 2)],
                              stdout=subprocess.DEVNULL)
    time.sleep(1)
    rows = measure(doctor.pid, seconds)
    doctor.wait()
    return max(cpu for _, cpu, _ in rows)


def main():
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 10
    empty_before = empty_loop(seconds / 2)
    with tempfile.TemporaryDirectory() as data:
        server = Server(data)
        server.create(scene=SCENE)
        agent = subprocess.Popen(
            [AGENT, "--server", f"http://127.0.0.1:{server.port}", "--session", "block",
             "--device", "sim", "--duration", str(WARM_UP_S + seconds + 2)],
            stdout=subprocess.PIPE, text=True)
        time.sleep(WARM_UP_S)
        rows = measure(agent.pid, seconds)
        memory_mb = resident_mb(agent.pid)
        summary = agent.communicate()[0]
        server.stop()
    print(f"{'thread':16} {'CPU %':>7} {'wake-ups/s':>11}")
    for role in [*ROLES.values(), "other"]:
        of_role = [row[1:] for row in rows if row[0] == role]
        print(f"{role:16} {sum(c for c, _ in of_role):7.2f} {sum(w for _, w in of_role):11.0f}")
    print(f"{'together':16} {sum(r[1] for r in rows):7.2f} {sum(r[2] for r in rows):11.0f}")
    print(f"{'an empty loop':16} {empty_before:7.2f} before, {empty_loop(seconds / 2):.2f} after")
    print(f"resident {memory_mb:.1f} MB")
    print(*[line for line in summary.splitlines() if "replica" in line or "loop" in line], sep="\n")


if __name__ == "__main__":
    main()
