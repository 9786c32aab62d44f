# SPDX-License-Identifier: Apache-2.0
"""Servers that cannot reach NATS, NATS without one of its own, clocks that jump: never two owners,
nothing lost."""
import glob
import http.client
import json
import os
import resource
import signal
import sys
import tempfile
import threading
import time
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import nats_server  # noqa: E402
from cluster_servers import Cluster, ClusterAgent, RasterPath, uninterrupted  # noqa: E402
from delaying_relay import Line, Relay  # noqa: E402
from kept_logs import run_tests  # noqa: E402
from live_server import SCENE, Server, until  # noqa: E402
from waiting import eventually  # noqa: E402
from wire_client import Closed, WebSocket  # noqa: E402


class Owners(threading.Thread):
    """Asks all servers all the time which of them may change the session; notes each answer.

    Cluster.owner() fails when two of them may.
    """

    def __init__(self, cluster):
        super().__init__(daemon=True)
        self.cluster, self.seen, self.fault = cluster, [], None
        self.ended = threading.Event()

    def run(self):
        while not self.ended.wait(0.02):
            try:
                owner = self.cluster.owner()
            except AssertionError as fault:
                self.fault = fault
                return
            except (OSError, http.client.HTTPException):
                continue  # a server ends, perhaps within an answer
            if owner and (not self.seen or self.seen[-1] != owner):
                self.seen.append(owner)

    def end(self):
        self.ended.set()
        self.join()
        if self.fault:
            raise self.fault
        return self.seen


class ClusterTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="kerf-test-")
        self.addCleanup(self.folder.cleanup)
        self.cluster = Cluster(self.folder.name, self.nats())
        self.addCleanup(self.cluster.end)

    def nats(self):
        return None  # one

    def tearDown(self):
        while WebSocket.opened:
            WebSocket.opened.pop().close()

    def carve_at_a(self):
        """An agent that has carved at server a, and the owners from then on."""
        agent = ClusterAgent(self.cluster, tip=RasterPath(0))
        agent.move(160)
        agent.settle()
        owners = Owners(self.cluster)
        owners.start()
        until(self, lambda: owners.seen, ["a"])
        return agent, owners

    def wait_for_renewals(self, count=5):
        """Waits until the lease was renewed so often: one that was not would have ended."""
        asked = json.dumps({"last_by_subj": "kerf.cluster.session.block"}).encode()
        seen = set()

        def has_seen():
            answer = self.cluster.nats.request("$JS.API.STREAM.MSG.GET.KERF_CLUSTER", asked)
            seen.add(answer["message"]["seq"])
            return len(seen) > count

        eventually(has_seen, lambda: f"the lease was renewed {len(seen) - 1} times only")

    def block(self, name):
        info = self.cluster.servers[name].info()
        return info["motions"], info["state_hash"]

    def expected(self, *agents):
        """The block of the agents' samples, had nothing happened."""
        info = uninterrupted(self.folder.name, agents)
        return info["motions"], info["state_hash"]


class Partition(ClusterTest):
    def test_an_owner_that_nats_does_not_hear_pauses_before_another_one_goes_on(self):
        with Relay(self.cluster.nats.port, Line()) as line:
            a = self.cluster.start("a", nats=f"nats://127.0.0.1:{line.port}")
            a.create()
            self.cluster.start("b")
            agent, owners = self.carve_at_a()
            line.hold(True)
            del self.cluster.servers["a"]  # no agent comes to it any more
            self.assertEqual(self.cluster.wait_for_owner(), "b")
            self.cluster.servers["a"] = a
            self.assertEqual(a.info()["paused"], "lease")
            stopped = a.info()["motions"]
            agent.move(16)  # at a, where it still is: rejected, or it finds b
            second = ClusterAgent(self.cluster_of("b"), tip=RasterPath(1))
            second.move(160)
            second.settle()
            self.assertEqual(a.info()["motions"], stopped)
            line.hold(False)
            until(self, lambda: a.http.request("GET", "/v1/sessions/block")[0], 307)
            try:
                while True:  # its bye
                    agent.socket.receive()
            except (Closed, OSError):
                agent.connect(None)
            agent.move(64)
            agent.settle()
            self.assertEqual(owners.end(), ["a", "b"])
            self.assertEqual(self.block("b"), self.expected(agent, second))

    def cluster_of(self, *names):
        """The same servers, as an agent sees them that knows only some."""
        return type("Part", (), {"servers": {n: self.cluster.servers[n] for n in names}})

    def test_an_owner_whose_disk_is_full_keeps_its_session_until_it_is_gone(self):
        a = self.cluster.start("a")
        a.create()
        self.cluster.start("b")
        agent, owners = self.carve_at_a()
        hard = resource.prlimit(a.process.pid, resource.RLIMIT_FSIZE)[1]
        resource.prlimit(a.process.pid, resource.RLIMIT_FSIZE, (0, hard))
        agent.move(16)  # cut, and never on that disk
        until(self, lambda: a.info()["paused"], "disk")
        self.wait_for_renewals()
        b = self.cluster.servers["b"]
        self.assertEqual(b.http.request("GET", "/v1/sessions/block")[0], 307)
        self.assertEqual(a.info()["paused"], "disk")
        self.cluster.stop("a", signal.SIGKILL)
        agent.move(64)
        agent.settle()
        self.assertEqual(owners.end(), ["a", "b"])
        self.assertEqual(self.block("b"), self.expected(agent))

    def test_two_servers_and_one_folder(self):
        a = self.cluster.start("a")
        a.create()
        agent = ClusterAgent(self.cluster)
        agent.move(100)
        agent.settle()
        with self.assertRaisesRegex(RuntimeError, "in use"):
            Server(self.cluster.path("a"), "--nats", self.cluster.nats.url, "--node", "b")
        self.assertEqual(a.info()["paused"], None)
        self.cluster.stop("a", signal.SIGKILL)
        # Another one with the same folder, and under the same name, goes on with it.
        self.cluster.servers["again"] = Server(self.cluster.path("a"), "--nats",
                                               self.cluster.nats.url, "--node", "a")
        self.assertEqual(self.cluster.wait_for_owner(), "again")
        agent.move(50)
        agent.settle()
        self.assertEqual(self.block("again"), self.expected(agent))


class Clock:
    """The time of day of one server, which jumps (Debian package libfaketime)."""

    LIBRARY = next(iter(glob.glob("/usr/lib/*/faketime/libfaketimeMT.so.1")), None)

    def __init__(self, path):
        self.path = path
        self.jump_to(0)
        self.environment = {"LD_PRELOAD": self.LIBRARY, "FAKETIME_TIMESTAMP_FILE": path,
                            "FAKETIME_NO_CACHE": "1", "FAKETIME_DONT_FAKE_MONOTONIC": "1"}

    @staticmethod
    def remove_shared_memory(pid):
        """Of a process that was killed."""
        for path in glob.glob(f"/dev/shm/*faketime_*_{pid}"):
            os.remove(path)

    def jump_to(self, offset_s):
        with open(self.path + ".new", "w") as file:
            file.write(f"{offset_s:+d}")
        os.replace(self.path + ".new", self.path)


@unittest.skipIf(Clock.LIBRARY is None, "libfaketime is not installed")
class ClockJumps(ClusterTest):
    def test_the_time_of_day_decides_nothing(self):
        clocks = {name: Clock(os.path.join(self.folder.name, f"clock of {name}")) for name in "ab"}
        for name, clock in clocks.items():
            server = self.cluster.start(name, environment=clock.environment)
            self.addCleanup(clock.remove_shared_memory, server.process.pid)
        self.cluster.servers["a"].create()
        agent, owners = self.carve_at_a()
        day_s = 86400
        for jump_s in (day_s, -day_s, 0):
            clocks["a"].jump_to(jump_s)
            clocks["b"].jump_to(-jump_s)
            agent.move(64)
            agent.settle()
            until(self, lambda: round((self.active_s("a") - time.time()) / day_s) * day_s, jump_s)
            self.wait_for_renewals()
        self.assertEqual(self.cluster.owner(), "a")
        self.cluster.stop("a", signal.SIGKILL)
        agent.move(64)
        agent.settle()
        self.assertEqual(owners.end(), ["a", "b"])
        self.assertEqual(self.block("b"), self.expected(agent))

    def active_s(self, name):
        """When a session was carved last, by its server's clock."""
        return self.cluster.servers[name].info()["active_ms"] / 1000


class NatsCluster(ClusterTest):
    """Three nats-servers, of which two at least keep a message before it is acknowledged."""

    def nats(self):
        self.trio = nats_server.Trio(self.folder.name)
        return self.trio

    def test_nothing_is_lost_when_a_server_of_nats_is_killed(self):
        for name in ("a", "b"):
            self.cluster.start(name, "--nats-replicas", "3")
        # The streams of the leases and of the journal elect their leaders first.
        path, scene = "/v1/sessions?id=block&here=1", json.dumps(SCENE)
        until(self, lambda: self.cluster.servers["a"].http.request("POST", path, scene)[0], 201)
        agent = ClusterAgent(self.cluster, tip=RasterPath(0))
        agent.move(320)
        agent.settle()
        owners = Owners(self.cluster)
        owners.start()
        agent.move(16)  # cut, and perhaps not copied yet
        self.trio.kill(self.trio.leader("KERF_JOURNAL_block"))
        agent.settle()  # when they are copied
        until(self, lambda: self.cluster.owner() is not None, True, 60)
        agent.move(320)
        agent.settle()
        owners.end()
        self.assertEqual(self.block(self.cluster.wait_for_owner()), self.expected(agent))


if __name__ == "__main__":
    if nats_server.PROGRAM is None:
        print("skipped: nats-server is not installed")
        sys.exit(77)
    run_tests()
