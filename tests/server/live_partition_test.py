# SPDX-License-Identifier: Apache-2.0
"""A disk that is full, a folder for two servers, NATS without one of its own: never two owners, nothing
lost. What partitions and clocks that jump do is in tests/sim."""
import http.client
import json
import os
import resource
import signal
import sys
import tempfile
import threading
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import nats_server  # noqa: E402
from cluster_servers import Cluster, ClusterAgent, RasterPath, uninterrupted  # noqa: E402
from kept_logs import run_tests  # noqa: E402
from live_server import SCENE, Server, until  # noqa: E402
from waiting import eventually  # noqa: E402
from wire_client import WebSocket  # noqa: E402


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
