#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures the load that one agent causes while it carves: CPU time, wake-ups and memory.

    KERF_SERVER=.../bin/kerf-server KERF_AGENT=.../bin/kerf-agent tests/bench/agent_load.py [SECONDS]

A server on loopback, an agent with a simulated hand that carves its figure in a block of 60 mm at a
pitch of 0.25 mm. After 4 s, in which it arms and enters the stock, it reads /proc for SECONDS (10):
per thread the CPU time and the wake-ups (voluntary context switches), and the resident memory.
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "server"))

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
    """Returns {thread: (name, CPU seconds, wake-ups)}."""
    threads = {}
    for task in pathlib.Path(f"/proc/{pid}/task").iterdir():
        seconds = int((task / "schedstat").read_text().split()[0]) * 1e-9
        status = dict(line.split(":\t", 1) for line in (task / "status").read_text().splitlines())
        threads[task.name] = (status["Name"], seconds, int(status["voluntary_ctxt_switches"]))
    return threads


def resident_mb(pid):
    status = pathlib.Path(f"/proc/{pid}/status").read_text()
    return int(status.split("VmRSS:")[1].split()[0]) / 1024


def main():
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 10
    with tempfile.TemporaryDirectory() as data:
        server = Server(data)
        server.create(scene=SCENE)
        agent = subprocess.Popen(
            [os.environ["KERF_AGENT"], "--server", f"http://127.0.0.1:{server.port}", "--session",
             "block", "--device", "sim", "--duration", str(WARM_UP_S + seconds + 2)],
            stdout=subprocess.PIPE, text=True)
        time.sleep(WARM_UP_S)
        before, start = threads_of(agent.pid), time.monotonic()
        time.sleep(seconds)
        after, passed = threads_of(agent.pid), time.monotonic() - start
        memory_mb = resident_mb(agent.pid)
        summary = agent.communicate()[0]
        server.stop()
    print(f"{'thread':16} {'CPU %':>7} {'wake-ups/s':>11}")
    rows = [(name, 100 * (cpu - before.get(task, (name, 0, 0))[1]) / passed,
             (wakes - before.get(task, (name, 0, 0))[2]) / passed)
            for task, (name, cpu, wakes) in sorted(after.items())]
    for name, cpu, wakes in rows:
        print(f"{name:16} {cpu:7.2f} {wakes:11.0f}")
    print(f"{'together':16} {sum(r[1] for r in rows):7.2f} {sum(r[2] for r in rows):11.0f}")
    print(f"resident {memory_mb:.1f} MB")
    print(*[line for line in summary.splitlines() if "replica" in line or "loop" in line], sep="\n")


if __name__ == "__main__":
    main()
