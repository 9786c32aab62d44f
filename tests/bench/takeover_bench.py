# SPDX-License-Identifier: Apache-2.0
"""How long it takes until another server goes on with a session whose owner was killed.

KERF_SERVER=build/release/bin/kerf-server python3 tests/bench/takeover_bench.py --rounds 20

Two servers and one nats-server on this machine; one agent at about 1 kHz, which tries the servers
by turns every 20 ms. In each round the owner gets SIGKILL, and is started again in the next one.
"""
import argparse
import os
import random
import statistics
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "server"))

from cluster_servers import Cluster, ClusterAgent  # noqa: E402
from live_resume_test import DurableAgent  # noqa: E402
from live_server import Server  # noqa: E402


def one_round(cluster, agent, chance):
    """Kills the owner; returns the s until the agent's next sample was cut by another server."""
    for _ in range(chance.randrange(20, 80)):
        agent.move(16)
    owner = cluster.owner()
    process = cluster.servers.pop(owner).process
    process.kill()
    killed = time.monotonic()
    process.communicate()
    agent.move(16)  # comes back when these are cut
    cut = time.monotonic() - killed
    cluster.start(owner)
    agent.settle()
    return cut


def main():
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--rounds", type=int, default=20)
    options.add_argument("--seed", type=int, default=1)
    options = options.parse_args()
    chance = random.Random(options.seed)
    with tempfile.TemporaryDirectory(prefix="kerf-bench-") as folder:
        cluster = Cluster(folder)
        try:
            cluster.start("a").create()
            cluster.start("b")
            agent = ClusterAgent(cluster)
            times = [one_round(cluster, agent, chance) for _ in range(options.rounds)]
            info = cluster.servers[cluster.owner()].info()
        finally:
            cluster.end()
        plain = Server(os.path.join(folder, "plain"))
        plain.create()
        whole = DurableAgent(plain.port, "block")
        for first in range(0, len(agent.sent), 16):
            time.sleep(0.016)
            whole.move(min(16, len(agent.sent) - first))
        expected = plain.info()
        plain.stop()
    times.sort()
    print(f"{options.rounds} kills, {len(agent.sent)} samples, epochs {agent.epochs[0]} to "
          f"{agent.epochs[-1]}")
    print(f"cut again after: least {times[0]:.2f}, median {statistics.median(times):.2f}, "
          f"most {times[-1]:.2f} s")
    same = (info["motions"], info["state_hash"]) == (expected["motions"], expected["state_hash"])
    print("block of an uninterrupted run:", "equal" if same else "DIFFERENT")
    return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main())
