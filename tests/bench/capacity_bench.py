# SPDX-License-Identifier: Apache-2.0
"""Measures the cost of an idle session and of a carved one, at a server of a cluster.

KERF_SERVER=build/release/bin/kerf-server KERF_AGENT=build/release/bin/kerf-agent \\
  python3 tests/bench/capacity_bench.py

One server with --node and one nats-server on this machine. Prints the memory and CPU time of both
for each idle session, CPU time while one agent at about 1 kHz cuts in one of them, and the
bytes that its motions take at NATS. The agent's own time is not counted.
"""
import argparse
import json
import os
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "server"))

from cluster_servers import Cluster, ClusterAgent, RasterPath  # noqa: E402
from live_server import SCENE  # noqa: E402

TICKS = os.sysconf("SC_CLK_TCK")


class Usage:
    """CPU time and memory of a process."""

    def __init__(self, process):
        with open(f"/proc/{process.pid}/stat", encoding="ascii") as file:
            fields = file.read().rpartition(")")[2].split()
        self.cpu_s = (int(fields[11]) + int(fields[12])) / TICKS
        with open(f"/proc/{process.pid}/smaps_rollup", encoding="ascii") as file:
            self.kb = next(int(line.split()[1]) for line in file if line.startswith("Pss:"))


def cpu_ms_per_s(processes, seconds, work=lambda: time.sleep(0.1)):
    """Returns the CPU time of each process, in ms per second, while `work` is repeated."""
    before, begin = [Usage(p) for p in processes], time.monotonic()
    while time.monotonic() - begin < seconds:
        work()
    took = time.monotonic() - begin
    return [1000 * (Usage(p).cpu_s - b.cpu_s) / took for p, b in zip(processes, before)]


def main():
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--sessions", type=int, default=60)
    options.add_argument("--seconds", type=float, default=20)
    options = options.parse_args()
    with tempfile.TemporaryDirectory(prefix="kerf-bench-") as folder:
        cluster = Cluster(folder)
        try:
            server = cluster.start("a")
            server.create()
            both = [server.process, cluster.nats.process]
            time.sleep(2)
            empty = [Usage(p) for p in both]
            empty_cpu = cpu_ms_per_s(both, options.seconds)
            for n in range(options.sessions):
                server.create(f"s{n}", dict(SCENE, name=f"s{n}"))
            time.sleep(2)
            full = [Usage(p) for p in both]
            full_cpu = cpu_ms_per_s(both, options.seconds)
            agent = ClusterAgent(cluster, tip=RasterPath(0))
            stored = cluster.nats.bytes_of("KERF_JOURNAL_block")
            carving = cpu_ms_per_s(both, options.seconds, lambda: agent.move(16))
            agent.settle()
            stored = cluster.nats.bytes_of("KERF_JOURNAL_block") - stored
        finally:
            cluster.end()
    for what, n in (("kerf-server", 0), ("nats-server", 1)):
        count = options.sessions
        print(f"{what}: {empty[n].kb / 1000:.1f} MB and {empty_cpu[n]:.2f} ms of CPU a second with "
              f"one session; each other one {(full[n].kb - empty[n].kb) / count:.0f} kB and "
              f"{(full_cpu[n] - empty_cpu[n]) / count:.3f} ms/s; an agent that cuts "
              f"{carving[n] - full_cpu[n]:.1f} ms/s")
    rate = len(agent.sent) / options.seconds
    print(f"{json.dumps(SCENE['accuracy'])}: {rate:.0f} motions/s, "
          f"{stored / len(agent.sent):.1f} B a motion at NATS")


if __name__ == "__main__":
    main()
