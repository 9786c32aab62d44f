# SPDX-License-Identifier: Apache-2.0
"""Several kerf-servers that share sessions over one nats-server, and what their agents may expect."""
import os
import signal
import threading
import time

import nats_server
from live_resume_test import DurableAgent, spiral_tip
from live_server import Server
from waiting import eventually
from wire_client import Closed, Rejected


class Cluster:
    """NATS and servers named a, b, ..., each with a folder of its own below `folder`."""

    def __init__(self, folder, nats=None):
        self.folder = folder
        self.nats = nats or nats_server.Nats(self.path("nats"))
        self.servers = {}

    def path(self, name):
        path = os.path.join(self.folder, name)
        os.makedirs(path, exist_ok=True)
        return path

    def start(self, name, *more, nats=None, environment=None):
        self.servers[name] = Server(self.path(name), "--nats", nats or self.nats.url, "--node", name,
                                    *more, environment=environment)
        return self.servers[name]

    def stop(self, name, how=signal.SIGTERM):
        return self.servers.pop(name).stop(how)

    def end(self):
        for server in self.servers.values():
            server.stop(signal.SIGKILL)
        self.nats.stop()

    def owner(self, session="block"):
        """The name of the server that may change a session; None: none may at the moment."""
        def runs(server):
            status, info = server.http.json("GET", f"/v1/sessions/{session}")
            return status == 200 and info["paused"] is None and not info["followed"]

        owners = [(name, server) for name, server in list(self.servers.items()) if runs(server)]
        # They are asked one after the other: the lease of the first may have run out meanwhile.
        owners = [o for o in owners[:-1] if runs(o[1])] + owners[-1:]
        assert len(owners) < 2, f"two servers run the session: {[name for name, _ in owners]}"
        return owners[0][0] if owners else None

    def wait_for_owner(self, session="block", among=None):
        def found():
            owner = self.owner(session)
            return owner if among is None or owner in among else None

        return eventually(found, f"nobody runs {session}")


class RasterPath:
    """Places that cover a quarter of the block of live_server, layer by layer.

    Each sample dips by another depth, so that the block without any one of them differs.
    """

    def __init__(self, quarter):
        self.corner = (-18 + 18 * (quarter % 2), -18 + 18 * (quarter // 2))

    def __call__(self, number):
        row, along = divmod(number, 40)
        layer, row = divmod(row, 40)
        if row % 2:
            along = 39 - along
        dip = (number * 0.618034) % 1
        return (self.corner[0] + 0.4 * along, self.corner[1] + 0.4 * row,
                -0.6 - 0.4 * layer - 0.4 * dip)


class HistoryError(Exception):
    """A server has taken back what one has acknowledged."""


class ClusterAgent(DurableAgent):
    """A DurableAgent that finds its session at any of the servers, and notes what they state.

    Its history is checked while it goes on: epochs grow, and what has been acknowledged stays.
    `tip` is the place of each sample.
    """

    def __init__(self, cluster, session="block", tip=spiral_tip):
        self.cluster, self.tip = cluster, tip
        self.epochs = []
        super().__init__(None, session)

    def connect(self, port):
        faults = []

        def connects_to(server):
            try:
                super(ClusterAgent, self).connect(server.port)
                return True
            except (OSError, Closed, Rejected, AssertionError) as fault:
                faults[:] = [fault]
                return False

        eventually(lambda: any(map(connects_to, list(self.cluster.servers.values()))),
                   lambda: f"no server takes the agent: {faults}")

    def send(self, first):
        resume = self.welcome["resume"]
        if not self.epochs or self.epochs[-1] != self.epoch:
            if self.epochs and (self.epoch < self.epochs[-1] or not resume["resumed"] or
                                resume["agent_sequence"] < self.durable):
                raise HistoryError(f"{self.welcome} after epochs {self.epochs} and "
                                   f"{self.durable} durable samples")
            self.epochs.append(self.epoch)
        super().send(first)

    def move(self, count):
        """Cuts, at whichever server, below the limit of samples a second."""
        time.sleep(count / 1000)
        first = len(self.sent) + 1
        self.sent += [self.tip(len(self.sent) + i) for i in range(count)]
        while True:
            try:
                return self.send(first)
            except (OSError, Closed, IndexError):
                self.connect(None)  # which sends everything again
                return None

    def cut_all(self, samples):
        """Cuts samples as if nothing had happened to anybody."""
        for first in range(0, len(samples), 16):
            time.sleep(0.016)
            self.sent += samples[first:first + 16]
            self.send(first + 1)

    def settle(self):
        """Waits until everything is acknowledged."""
        def is_settled():
            if self.durable < len(self.sent):
                try:
                    self.ping()
                except (OSError, Closed, IndexError):
                    self.connect(None)
            return self.durable >= len(self.sent)

        eventually(is_settled, lambda: f"{self.durable} of {len(self.sent)} samples are durable")


def uninterrupted(folder, agents):
    """What a server to which nothing happens says of a session with the samples of `agents`."""
    plain = Server(os.path.join(folder, "plain"))
    plain.create()
    alone = type("Alone", (), {"servers": {"plain": plain}})
    whole = [ClusterAgent(alone) for _ in agents]
    threads = [threading.Thread(target=one.cut_all, args=(agent.sent,))
               for one, agent in zip(whole, agents)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    info = plain.info()
    plain.stop()
    return info
