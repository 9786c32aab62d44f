# SPDX-License-Identifier: Apache-2.0
"""Viewers watch a session at servers that follow it, and one of these goes on with it at once."""
import json
import os
import random
import signal
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from cluster_servers import Cluster, ClusterAgent, RasterPath, uninterrupted  # noqa: E402
from kept_logs import run_tests  # noqa: E402
from live_copy_test import is_copied_to  # noqa: E402
from hands import spiral, stroke  # noqa: E402
from live_server import SCENE, until  # noqa: E402
from wire_client import TOOLS, Agent, Viewer, WebSocket  # noqa: E402


class Relays(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="kerf-test-")
        self.addCleanup(self.folder.cleanup)
        self.cluster = Cluster(self.folder.name)
        self.addCleanup(self.cluster.end)
        self.a = self.cluster.start("a")
        self.a.create()
        # What has no copy yet cannot be followed, and is tried again after seconds only.
        until(self, self.has_copy, True)

    def tearDown(self):
        while WebSocket.opened:
            WebSocket.opened.pop().close()

    def has_copy(self):
        info = self.a.info()
        return is_copied_to(info, info["state_sequence"])

    def follower(self, name="b", follow="viewed"):
        """A server that knows of the session and has nothing of it."""
        server = self.cluster.start(name, "--follow", follow)
        until(self, lambda: len(server.http.json("GET", "/v1/sessions")[1]["sessions"]), 1)
        return server

    @staticmethod
    def block(server):
        """What a server shows of the session; None: nothing yet, or at the moment."""
        status, info = server.http.json("GET", "/v1/sessions/block")
        if status != 200:
            return None
        return info["motions"], info["state_hash"], info["state_sequence"]

    def wait_until_equal(self, *servers):
        def is_equal(server):
            block = self.block(server)
            return block is not None and block == self.block(self.a)

        for server in servers:
            until(self, lambda s=server: is_equal(s), True)

    def post(self, path, body=None):
        status, answer = self.a.http.json("POST", "/v1/sessions/block/" + path, body)
        self.assertLess(status, 300, answer)
        return answer

    def test_a_server_that_only_follows_shows_sessions_and_runs_none(self):
        b = self.follower(follow="only")
        Viewer(b.port, "block").settled()
        scene = json.dumps(dict(SCENE, name="other"))

        def place_for_new():
            return b.http.request("POST", "/v1/sessions", scene)[1].get("location")

        until(self, place_for_new, f"http://127.0.0.1:{self.a.port}/v1/sessions?here=1")
        status, answer = b.http.json("POST", "/v1/sessions?here=1", scene)
        self.assertEqual((status, answer["error"]["code"]), (503, "no_lease"))
        self.assertIn("only follows", answer["error"]["reason"])
        self.cluster.stop("a", signal.SIGKILL)
        # The lease is free, and has been for as long as it took the third server to get it.
        self.a = self.cluster.start("c")
        self.assertEqual(self.cluster.wait_for_owner(), "c")
        self.wait_until_equal(b)
        self.assertTrue(b.info()["followed"])

    def test_viewers_see_the_same_block_at_a_server_that_follows_through_undo_and_redo(self):
        b, chance = self.follower(), random.Random(5)
        here, there = Viewer(self.a.port, "block"), Viewer(b.port, "block")
        here.keeps_meshes = there.keeps_meshes = True
        hands = [Agent(self.a.port, "block", name) for name in ("Ada", "Bo")]
        for n in range(8):
            hand = hands[n % 2]
            stroke(hand, chance.uniform(-15, 15), depth=chance.uniform(-6, -1))
            if n % 3 == 2:
                self.post(f"undo?participant={hand.participant}")
            if n == 5:
                self.post(f"redo?participant={hand.participant}")
        self.wait_until_equal(b)
        expected = self.a.hash()
        for viewer in (here, there):
            until(self, lambda v=viewer: v.settled()["state_hash"], expected)
        self.assertEqual(there.meshes, here.meshes)
        self.assertGreater(len(there.meshes), 4)
        self.assertTrue(b.info()["followed"])

    def test_what_only_looks_is_answered_there_and_the_rest_is_sent_to_the_owner(self):
        agent = ClusterAgent(self.cluster)
        agent.move(200)
        agent.settle()
        b = self.follower()
        self.post("versions?name=first")
        self.post("pins?text=here&at_mm=0,0,0&normal=0,0,1")
        self.wait_until_equal(b)
        for path in ("model.stl", "model.glb", "program.ngc", "forces.csv", "strokes", "versions",
                     "pins", "picture.png", "journal"):
            url = "/v1/sessions/block/" + path
            status, _, expected = self.a.http.request("GET", url)
            self.assertEqual(status, 200, path)
            until(self, lambda u=url: b.http.request("GET", u)[2], expected)
        for method, path in (("POST", "undo"), ("POST", "pins"), ("GET", "programs"),
                             ("DELETE", "")):
            status, headers, _ = b.http.request(method, "/v1/sessions/block" + (path and "/" + path))
            self.assertEqual((status, headers.get("location", "")[:22]),
                             (307, f"http://127.0.0.1:{self.a.port}"[:22]), (method, path))
        socket = WebSocket(b.port, "/v1/sessions/block/agent", "kerf.agent.v1")
        self.assertEqual(socket.receive_json("bye")["redirect"],
                         f"http://127.0.0.1:{self.a.port}")

    def test_viewers_there_see_who_carves_and_are_counted_here(self):
        b = self.follower()
        here, there = Viewer(self.a.port, "block"), Viewer(b.port, "block", "Vi")
        agent = Agent(self.a.port, "block", "Ada")
        agent.move([(0, 0, 1), (0, 0, -1), (5, 0, -1)])
        agent.result()
        program = self.post("programs?pace=feed&speed=0.1&name=s.ngc", spiral(2000))

        def newest(viewer, kind):
            while viewer.take() != kind:
                pass
            return viewer.last

        def names():
            message = newest(there, "participants")
            return {p["name"] for p in message["participants"]}

        until(self, lambda: {"Ada", "s.ngc", "Vi"} <= names(), True)
        until(self, lambda: newest(there, "programs")["programs"][0]["id"], program["id"])
        until(self, lambda: there.take() == TOOLS and
              sorted(tool[0] for tool in there.tools), sorted([agent.participant,
                                                               program["participant"]]))
        until(self, lambda: newest(here, "participants")["viewers"], 2)
        there.close()
        agent.move([(6, 0, -1)])
        until(self, lambda: newest(here, "participants")["viewers"], 1)

    def test_a_server_that_follows_goes_on_when_the_owner_is_killed_and_nothing_is_lost(self):
        b = self.follower(follow="all")
        agent = ClusterAgent(self.cluster, tip=RasterPath(0))
        agent.move(400)
        agent.settle()
        until(self, lambda: b.http.json("GET", "/v1/sessions/block")[1].get("followed"), True)
        self.wait_until_equal(b)
        viewer = Viewer(b.port, "block")
        for name, heir in (("a", "b"), ("b", "a")):
            agent.move(100)
            owner = self.cluster.servers.pop(name)
            owner.stop(signal.SIGKILL)
            agent.move(100)
            agent.settle()
            self.assertEqual(self.cluster.wait_for_owner(), heir)
            self.cluster.start(name, "--follow", "all")
            until(self, lambda n=name: self.cluster.servers[n].http.json(
                "GET", "/v1/sessions/block")[1].get("followed"), True)
        self.assertEqual(viewer.receive_json("bye")["type"], "bye")
        info = self.cluster.servers["a"].info()
        whole = uninterrupted(self.folder.name, [agent])
        self.assertEqual((info["motions"], info["state_hash"]),
                         (whole["motions"], whole["state_hash"]))

    def test_it_follows_on_when_the_session_moves_and_when_nats_comes_back(self):
        b = self.follower()
        b.create("other", dict(SCENE, name="other"))  # so c has the fewest sessions
        viewer = Viewer(b.port, "block")
        c = self.cluster.start("c")
        until(self, lambda: len(c.http.json("GET", "/v1/sessions")[1]["sessions"]), 2)
        until(self, lambda: len(Viewer(self.a.port, "block").welcome.get("others", [])), 2)
        agent = ClusterAgent(self.cluster, tip=RasterPath(1))
        agent.move(100)
        self.cluster.stop("a")
        self.assertEqual(self.cluster.wait_for_owner(), "c")
        agent.move(100)
        agent.settle()
        self.a = c
        self.wait_until_equal(b)
        self.cluster.nats.stop(signal.SIGKILL)
        agent.move(16)  # cut, and not copied
        # While the lease lasts: afterwards any server may take the session.
        until(self, lambda: "cannot be reached" in (c.info()["copied"].get("fault") or ""), True)
        self.cluster.nats.start()
        until(self, lambda: self.cluster.owner(), "c")
        agent.move(100)
        agent.settle()
        self.wait_until_equal(b)
        until(self, lambda: viewer.settled()["state_hash"], c.hash())

    def test_it_ends_with_the_session(self):
        b = self.follower()
        viewer = Viewer(b.port, "block")
        self.a.http.request("DELETE", "/v1/sessions/block")
        self.assertEqual(viewer.receive_json("bye")["reason"], "the session has ended")
        self.assertEqual(b.http.request("GET", "/v1/sessions/block")[0], 404)


if __name__ == "__main__":
    run_tests()
