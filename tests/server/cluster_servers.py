# SPDX-License-Identifier: Apache-2.0
"""Several kerf-servers that share sessions over one nats-server, and what their agents may expect."""
import math
import os
import signal
import sqlite3
import struct
import threading
import time

import nats_server
from live_server import Server
from waiting import eventually
from wire_client import (CUTTING, MOTION, PING, PONG, RESULT, Closed, Rejected, WebSocket, header,
                         sample)


def batches(folder, session="block"):
    """The rows of a journal's records."""
    with sqlite3.connect(os.path.join(folder, session + ".kerf")) as database:
        return database.execute("SELECT * FROM batches ORDER BY first").fetchall()


def is_copied_to(info, record):
    """Whether the copy goes up to a record, and goes on."""
    copied = info["copied"]  # null right after a start
    return copied is not None and (copied["record"], copied["fault"]) == (record, None)


def spiral_tip(i):
    angle, radius = 0.02 * i, 4 + 0.01 * i
    return radius * math.cos(angle), radius * math.sin(angle), -2 - 0.002 * i


class DurableAgent:
    """Keeps its samples until the server has stated that they are durable."""

    def __init__(self, port, session):
        self.session, self.token, self.epoch = session, None, 0
        self.sent = []      # poses by number, from 1
        self.durable = 0
        self.connect(port)

    def connect(self, port):
        self.socket = WebSocket(port, f"/v1/sessions/{self.session}/agent", "kerf.agent.v1")
        hello = {"type": "hello", "name": "Ada", "tool": 1, "durable": True}
        if self.token:
            hello["resume"] = self.token
        self.socket.send_json(hello)
        self.welcome = self.socket.receive_json("welcome")
        self.epoch = self.welcome["epoch"]
        self.token = self.welcome["resume"]["token"]
        self.send(max(1, self.welcome["resume"]["agent_sequence"], self.durable))

    def send(self, first):
        """Sends the samples from number `first` on, and reads their answers."""
        numbers = range(first, len(self.sent) + 1)
        for start in range(0, len(numbers), 16):
            samples = [sample(n, 1000 * n, self.sent[n - 1], buttons=CUTTING)
                       for n in numbers[start:start + 16]]
            payload = struct.pack("<II", len(samples), 0) + b"".join(samples)
            self.socket.send_binary(header(MOTION, len(payload), epoch=self.epoch) + payload)
            self.wait(RESULT)

    def wait(self, kind):
        while True:
            form, frame = self.socket.receive()
            if form != "binary":
                continue
            flags, header_bytes = frame[5], struct.unpack("<H", frame[6:8])[0]
            if flags & 1 and header_bytes >= 40:
                self.durable = max(self.durable, struct.unpack("<Q", frame[32:40])[0])
            if frame[4] == kind:
                return frame[header_bytes:]

    def ping(self):
        self.socket.send_binary(header(PING, 8, epoch=self.epoch) + struct.pack("<Q", 1))
        self.wait(PONG)

    def move(self, count):
        first = len(self.sent) + 1
        self.sent += [spiral_tip(len(self.sent) + i) for i in range(count)]
        self.send(first)


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

    def start(self, name, *more):
        self.servers[name] = Server(self.path(name), "--nats", self.nats.url, "--node", name, *more)
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
        # Ask again: the servers are queried one after another, so the first one's lease may have
        # expired meanwhile.
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
                self.connect(None)  # sends everything again
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
