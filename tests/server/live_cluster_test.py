# SPDX-License-Identifier: Apache-2.0
"""Real servers and a real nats-server: another one goes on after a kill, a planned stop, the end of a
server of NATS, and with a copy. What else may happen to them is in tests/sim."""
import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import nats_server  # noqa: E402
from cluster_servers import (Cluster, ClusterAgent, DurableAgent, RasterPath, batches,  # noqa: E402
                             is_copied_to, uninterrupted)
from kept_logs import run_tests  # noqa: E402
from live_server import PROGRAM, SCENE, Server, until  # noqa: E402
from wire_client import Viewer, WebSocket  # noqa: E402


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

    def block(self, name):
        info = self.cluster.servers[name].info()
        return info["motions"], info["state_hash"]

    def expected(self, agent):
        """The block of the agent's samples, had nothing happened."""
        info = uninterrupted(self.folder.name, [agent])
        return info["motions"], info["state_hash"]

    def wait_for_other(self, server):
        """Waits until a server knows the other one, to which it sends its peers."""
        def others():
            socket = WebSocket(server.port, "/v1/sessions/block/view", "kerf.view.v1")
            socket.send_json({"type": "hello", "name": "Vi"})
            return len(socket.receive_json("welcome").get("others", []))

        until(self, others, 1)


class Takeover(ClusterTest):
    def setUp(self):
        super().setUp()
        self.a = self.cluster.start("a")
        self.a.create()

    def test_another_server_goes_on_after_each_kill_and_nothing_acknowledged_is_lost(self):
        self.cluster.start("b")
        agent = ClusterAgent(self.cluster, tip=RasterPath(0))
        agent.move(200)
        agent.settle()
        for n in range(2):
            owner = self.cluster.wait_for_owner()
            kill = threading.Timer(0.05 * n, self.cluster.servers[owner].process.kill)
            kill.start()
            while kill.is_alive():
                agent.move(16)
            self.cluster.servers.pop(owner).end()
            agent.move(64)
            self.assertNotEqual(self.cluster.wait_for_owner(), owner)
            self.cluster.start(owner)
        agent.settle()
        self.assertEqual(len(agent.epochs), 3)
        self.assertEqual(agent.welcome["participant"], 1)
        self.assertEqual(self.block(self.cluster.wait_for_owner()), self.expected(agent))

    def test_a_server_that_stops_hands_over_and_its_peers_are_sent_on(self):
        b = self.cluster.start("b")
        self.wait_for_other(self.a)
        agent = ClusterAgent(self.cluster, tip=RasterPath(0))
        viewer = Viewer(self.a.port, "block")
        agent.move(200)
        self.assertEqual(self.cluster.stop("a")[0], 0)
        self.assertEqual(viewer.receive_json("bye")["redirect"], f"http://127.0.0.1:{b.port}")
        self.assertEqual(self.cluster.wait_for_owner(), "b")
        self.assertEqual(batches(self.cluster.path("a")), batches(self.cluster.path("b")))
        agent.move(50)
        agent.settle()
        # Its own journal is stale now: it is not opened, and is replaced when the session returns.
        self.cluster.start("a")
        self.assertEqual(self.cluster.owner(), "b")
        self.wait_for_other(b)
        self.cluster.stop("b")
        self.assertEqual(self.cluster.wait_for_owner(), "a")
        self.assertEqual(self.block("a"), self.expected(agent))
        self.assertFalse(os.path.exists(os.path.join(self.cluster.path("a"), "closed")))


class Copy(ClusterTest):
    def start(self, name):
        """A server that copies its journals and shares no sessions."""
        self.cluster.servers[name] = Server(self.cluster.path(name), "--nats", self.cluster.nats.url)
        return self.cluster.servers[name]

    def run_server(self, *words):
        done = subprocess.run([PROGRAM, *words], capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_another_machine_continues_after_a_kill_and_the_agent_resumes(self):
        a = self.start("a")
        a.create()
        agent = DurableAgent(a.port, "block")
        agent.move(200)

        def is_whole():
            info = a.info()
            return info["journal_lag"] == 0 and is_copied_to(info, info["state_sequence"])

        until(self, is_whole, True)
        copied = a.info()["copied"]["record"]
        self.cluster.stop("a", signal.SIGKILL)
        journal = os.path.join(self.cluster.path("b"), "block.kerf")
        self.run_server("--nats", self.cluster.nats.url, "fetch", "block", journal)
        self.assertEqual(batches(self.cluster.path("b")), batches(self.cluster.path("a")))
        self.run_server("replay", journal)
        b = self.start("b")
        self.assertGreaterEqual(b.info()["state_sequence"], copied)
        agent.connect(b.port)
        self.assertTrue(agent.welcome["resume"]["resumed"])
        self.assertEqual(agent.welcome["participant"], 1)
        self.assertEqual(b.info()["epoch"], 3)
        agent.move(100)
        whole = Server(self.cluster.path("whole"))
        whole.create()
        DurableAgent(whole.port, "block").move(len(agent.sent))
        self.assertEqual(self.block("b"), (whole.info()["motions"], whole.hash()))
        whole.stop()


class NatsCluster(ClusterTest):
    """Three nats-servers, of which two at least keep a message before it is acknowledged."""

    def nats(self):
        self.trio = nats_server.Trio(self.folder.name)
        return self.trio

    def test_nothing_is_lost_when_a_server_of_nats_is_killed(self):
        for name in ("a", "b"):
            self.cluster.start(name, "--nats-replicas", "3")
        # The streams of the leases and the journal must elect their leaders first.
        path, scene = "/v1/sessions?id=block&here=1", json.dumps(SCENE)
        until(self, lambda: self.cluster.servers["a"].http.request("POST", path, scene)[0], 201)
        agent = ClusterAgent(self.cluster, tip=RasterPath(0))
        agent.move(160)
        agent.settle()
        agent.move(16)  # cut, but perhaps not copied yet
        self.trio.kill(self.trio.leader("KERF_JOURNAL_block"))
        agent.settle()  # returns once they are copied
        until(self, lambda: self.cluster.owner() is not None, True, 60)
        agent.move(160)
        agent.settle()
        self.assertEqual(self.block(self.cluster.wait_for_owner()), self.expected(agent))


if __name__ == "__main__":
    if nats_server.PROGRAM is None:
        print("skipped: nats-server is not installed")
        sys.exit(77)
    run_tests()
