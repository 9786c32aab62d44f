# SPDX-License-Identifier: Apache-2.0
"""Measures the time until another server continues a session whose owner was killed.

KERF_SERVER=build/release/bin/kerf-server KERF_AGENT=build/release/bin/kerf-agent \\
  python3 tests/bench/takeover_bench.py --rounds 20

Two servers and one nats-server on this machine; --agents (one) at about 1 kHz each, and --viewers
(none), which try the servers in turn every 20 ms. In each round the owner is killed (SIGKILL) and
restarted afterwards. Each agent cuts a region of its own, so that a lost sample changes the block,
and a sample that is cut twice changes the number of motions.

With --standby the second server follows the session, and leases last one second.

With --motions N a program cuts N motions first, and each owner is succeeded by a server without
any data of the session, which fetches the copy. --without-snapshots deletes the snapshots at NATS
before each kill, so that all records are replayed.
"""
import argparse
import contextlib
import faulthandler
import os
import random
import statistics
import sys
import tempfile
import threading
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "server"))

from cluster_servers import Cluster, ClusterAgent, RasterPath, uninterrupted  # noqa: E402
from hands import spiral  # noqa: E402
from wire_client import MESH, Closed, Rejected, Viewer, WebSocket  # noqa: E402


class Unkept(list):
    """Replaces WebSocket.opened, so that a socket is closed with its last reference."""

    def append(self, _):
        pass


class TimedAgent(ClusterAgent, threading.Thread):
    """Cuts at about 1 kHz, and records when its samples were first cut in each epoch."""

    def __init__(self, cluster, number):
        threading.Thread.__init__(self, daemon=True)
        self.ended, self.cut_in, self.fault = threading.Event(), {}, None
        ClusterAgent.__init__(self, cluster, tip=RasterPath(number))

    def send(self, first):
        super().send(first)
        if first <= len(self.sent):
            self.cut_in.setdefault(self.epoch, time.monotonic())

    def run(self):
        try:
            while not self.ended.is_set():
                self.move(16)
            self.settle()
        except Exception as fault:  # for the main thread
            self.fault = fault


class TimedViewer(threading.Thread):
    """Watches at any server, and records when it first received tiles in each epoch."""

    def __init__(self, cluster):
        super().__init__(daemon=True)
        self.cluster, self.ended, self.seen_in = cluster, threading.Event(), {}

    def run(self):
        while not self.ended.is_set():
            for server in list(self.cluster.servers.values()):
                try:
                    self.watch(Viewer(server.port, "block"))
                except (OSError, Closed, Rejected, AssertionError, KeyError):
                    time.sleep(0.02)

    def watch(self, viewer):
        with contextlib.closing(viewer):
            while not self.ended.is_set():
                if viewer.take() == MESH:
                    self.seen_in.setdefault(viewer.welcome["epoch"], time.monotonic())


STANDBY = ("--follow", "all", "--lease-ms", "1000")


def is_followed(server):
    info = server.http.json("GET", "/v1/sessions/block")[1]
    return info.get("followed", False)


def one_round(cluster, agents, viewers, chance, words):
    """Kills the owner. Returns the time, in s, until each agent's next samples were cut by another
    server, and until each viewer received tiles from it."""
    time.sleep(chance.uniform(0.5, 1.5))
    owner = cluster.owner()
    epoch = cluster.servers[owner].info()["epoch"]
    process = cluster.servers.pop(owner).process
    process.kill()
    killed = time.monotonic()
    process.communicate()

    def all_in(notes):
        return all(note and max(note) > epoch for note in notes)

    wait_until(lambda: all_in([agent.cut_in for agent in agents]) or any(a.fault for a in agents))
    for agent in agents:
        if agent.fault:
            raise agent.fault
    wait_until(lambda: all_in([viewer.seen_in for viewer in viewers]))
    again = cluster.start(owner, *words)
    wait_until(lambda: not words or is_followed(again))
    first = [[note[min(e for e in note if e > epoch)] - killed for note in notes] for notes in
             ([agent.cut_in for agent in agents], [viewer.seen_in for viewer in viewers])]
    return first


def wait_until(ask):
    while not ask():
        time.sleep(0.05)


def snapshot_of(server):
    """Returns the last record of the newest snapshot at NATS, or 0 without one."""
    return (server.info()["copied"] or {"snapshot": 0})["snapshot"]


def cut(server, motions):
    """Runs a program of that many motions, and waits until they are copied."""
    program = server.http.json("POST", "/v1/sessions/block/programs?pace=fast&name=s.ngc",
                               spiral(motions))[1]
    wait_until(lambda: server.http.json("GET", program["url"])[1]["state"] == "finished")
    wait_until(lambda: server.info()["copied"]["record"] == server.info()["state_sequence"])
    print(f"{motions} motions are cut and copied", flush=True)


def succeed(cluster, owner, heir, with_snapshots):
    """Kills the owner. Returns the s until `heir`, without data, may carve the session."""
    server = cluster.start(heir)
    if with_snapshots:  # those of the last 10 s come late
        wait_until(lambda: snapshot_of(cluster.servers[owner]) > 0)
    else:
        cluster.nats.delete("KERF_SNAPSHOT_block")
    snapshot = snapshot_of(cluster.servers[owner]) if with_snapshots else 0
    process = cluster.servers.pop(owner).process
    process.kill()
    killed = time.monotonic()
    wait_until(lambda: cluster.owner() == heir)
    taken = time.monotonic() - killed
    process.communicate()
    return taken, snapshot, server.info()


def cold_takeovers(options):
    with tempfile.TemporaryDirectory(prefix="kerf-bench-") as folder:
        cluster = Cluster(folder)
        try:
            owner = cluster.start("server0")
            owner.create()
            cut(owner, options.motions)
            before = owner.info()
            times, same = [], True
            for n in range(options.rounds):
                taken, snapshot, info = succeed(cluster, f"server{n}", f"server{n + 1}",
                                      not options.without_snapshots)
                owner = cluster.servers[f"server{n + 1}"]
                same = same and info["state_hash"] == before["state_hash"]
                times.append(taken)
            streams = [cluster.nats.bytes_of(f"KERF_{kind}_block") / 1e3
                       for kind in ("JOURNAL", "SNAPSHOT")]
        finally:
            cluster.end()
    times.sort()
    print(f"{options.rounds} kills, {before['state_sequence']} records, newest snapshot at NATS "
          f"before the last kill after record {snapshot or '(none)'}; there journal "
          f"{streams[0]:.0f} kB, snapshots {streams[1]:.0f} kB")
    print(f"the session goes on after: least {times[0]:.2f}, median "
          f"{statistics.median(times):.2f}, most {times[-1]:.2f} s")
    print("state hash after each:", "equal" if same else "DIFFERENT")
    return 0 if same else 1


def print_times(what, times):
    times.sort()
    if times:
        print(f"{what}: least {times[0]:.2f}, median {statistics.median(times):.2f}, "
              f"most {times[-1]:.2f} s")


def warm_takeovers(options):
    chance = random.Random(options.seed)
    with tempfile.TemporaryDirectory(prefix="kerf-bench-") as folder:
        cluster = Cluster(folder)
        try:
            words = STANDBY if options.standby else ()
            cluster.start("a", *words).create()
            b = cluster.start("b", *words)
            wait_until(lambda: not words or is_followed(b))
            agents = [TimedAgent(cluster, n) for n in range(options.agents)]
            viewers = [TimedViewer(cluster) for _ in range(options.viewers)]
            for thread in agents + viewers:
                thread.start()
            wait_until(lambda: all(v.seen_in for v in viewers))
            rounds = [one_round(cluster, agents, viewers, chance, words)
                      for _ in range(options.rounds)]
            for thread in agents + viewers:
                thread.ended.set()
            for thread in agents + viewers:
                thread.join()
            faults = [agent.fault for agent in agents if agent.fault]
            info = cluster.servers[cluster.owner()].info()
        finally:
            cluster.end()
        expected = uninterrupted(folder, agents)
    samples = sum(len(agent.sent) for agent in agents)
    print(f"{options.rounds} kills, {options.agents} agents, {options.viewers} viewers, "
          f"{samples} samples, epochs {agents[0].epochs[0]} to {agents[0].epochs[-1]}")
    print_times("cut again after", [s for agents_s, _ in rounds for s in agents_s])
    print_times("tiles again after", [s for _, viewers_s in rounds for s in viewers_s])
    same = (info["motions"], info["state_hash"]) == (expected["motions"], expected["state_hash"])
    print("acknowledgements taken back:", faults or "none")
    print("block of an uninterrupted run:", "equal" if same else "DIFFERENT")
    return 0 if same and not faults else 1


def main():
    faulthandler.cancel_dump_traceback_later()  # of the tests, which are shorter
    WebSocket.opened = Unkept()
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--rounds", type=int, default=20)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--agents", type=int, default=1)
    options.add_argument("--viewers", type=int, default=0)
    options.add_argument("--motions", type=int, default=0)
    options.add_argument("--standby", action="store_true")
    options.add_argument("--without-snapshots", action="store_true")
    options = options.parse_args()
    if options.motions:
        return cold_takeovers(options)
    chance = random.Random(options.seed)
    return warm_takeovers(options)


if __name__ == "__main__":
    sys.exit(main())
