# SPDX-License-Identifier: Apache-2.0
"""When a server is gone, or stops, another one goes on with its sessions, and never two of them."""
import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import nats_server  # noqa: E402
from cluster_servers import Cluster, ClusterAgent  # noqa: E402
from delaying_relay import Line, Relay  # noqa: E402
from kept_logs import keep, run_tests  # noqa: E402
from live_agent_test import AGENT, rows  # noqa: E402
from live_copy_test import batches, is_copied_to, run  # noqa: E402
from live_resume_test import DurableAgent  # noqa: E402
from live_server import SCENE, Server, until  # noqa: E402
from wire_client import CUTTING, MOTION, Closed, Viewer, WebSocket, header, sample  # noqa: E402


class Takeover(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="kerf-test-")
        self.addCleanup(self.folder.cleanup)
        self.cluster = Cluster(self.folder.name)
        self.addCleanup(self.cluster.end)
        self.a = self.cluster.start("a")
        self.addCleanup(self.a.process.kill)  # a test may take it from the cluster
        self.a.create()

    def tearDown(self):
        while WebSocket.opened:
            WebSocket.opened.pop().close()

    def info(self, name, session="block"):
        return self.cluster.servers[name].info(session)

    def wait_for_copy(self, server):
        def is_whole():
            info = server.info()
            return info["journal_lag"] == 0 and is_copied_to(info, info["state_sequence"])

        until(self, is_whole, True)

    def wait_for_others(self, server, count):
        """Waits until a server knows the others, to which it sends its peers."""
        def others():
            socket = WebSocket(server.port, "/v1/sessions/block/view", "kerf.view.v1")
            socket.send_json({"type": "hello", "name": "Vi"})
            return len(socket.receive_json("welcome").get("others", []))

        until(self, others, count)

    def uninterrupted(self, count):
        """What a server that nothing happens to makes of the same samples."""
        with tempfile.TemporaryDirectory(prefix="kerf-test-") as folder:
            server = Server(folder)
            server.create()
            DurableAgent(server.port, "block").move(count)
            info = server.info()
            server.stop()
        return info["motions"], info["state_hash"]

    def block(self, name):
        info = self.info(name)
        return info["motions"], info["state_hash"]

    def test_another_server_goes_on_after_each_kill_and_nothing_acknowledged_is_lost(self):
        self.cluster.start("b")
        agent = ClusterAgent(self.cluster)
        agent.move(200)
        agent.settle()
        for n in range(3):
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
        self.assertEqual(len(agent.epochs), 4)
        self.assertEqual(agent.welcome["participant"], 1)
        owner = self.cluster.wait_for_owner()
        self.assertEqual(self.block(owner), self.uninterrupted(len(agent.sent)))

    def test_a_stopped_owner_that_is_continued_changes_nothing(self):
        self.cluster.stop("a")
        line = Relay(self.cluster.nats.port, Line()).__enter__()
        self.addCleanup(line.__exit__)
        self.a = self.cluster.start("a", nats=f"nats://127.0.0.1:{line.port}")
        self.addCleanup(self.a.process.kill)
        self.assertEqual(self.cluster.wait_for_owner(), "a")
        b = self.cluster.start("b")
        agent = ClusterAgent(self.cluster)
        agent.move(100)
        agent.settle()
        # What NATS sends in the meantime waits until the samples have been answered.
        line.hold(True)
        self.a.process.send_signal(signal.SIGSTOP)
        try:
            del self.cluster.servers["a"]
            self.assertEqual(self.cluster.wait_for_owner(), "b")
            before = self.block("b")
            # It gets these when it wakes, and does not know yet that it is succeeded.
            acknowledged, numbers = agent.durable, range(101, 117)
            samples = [sample(n, 1000 * n, (6 - n * 0.01, 0.0, -1.0), buttons=CUTTING)
                       for n in numbers]
            payload = len(samples).to_bytes(4, "little") + bytes(4) + b"".join(samples)
            agent.socket.send_binary(header(MOTION, len(payload), epoch=agent.epoch) + payload)
        finally:
            self.a.process.send_signal(signal.SIGCONT)
        reasons = []
        try:
            while True:
                form, message = agent.socket.receive()
                if form == "text":
                    reasons.append(message)
                    if message["type"] == "error":
                        line.hold(False)
                elif message[5] & 1:
                    durable = int.from_bytes(message[32:40], "little")
                    self.assertLessEqual(durable, acknowledged)
        except (Closed, OSError):
            pass
        bye = reasons[-1]
        self.assertEqual((bye["type"], bye.get("redirect")),
                         ("bye", f"http://127.0.0.1:{b.port}"), reasons)
        self.assertIn("paused: lease", json.dumps(reasons[:-1]))
        self.assertEqual(self.block("b"), before)
        status, headers, _ = self.a.http.request("GET", "/v1/sessions/block/strokes?since=1")
        self.assertEqual((status, headers["location"]),
                         (307, f"http://127.0.0.1:{b.port}/v1/sessions/block/strokes?since=1"))
        self.wait_for_copy(b)
        to = os.path.join(self.cluster.path("copy"), "block.kerf")
        self.assertEqual(run("--nats", self.cluster.nats.url, "fetch", "block", to)[0], 0)
        self.assertEqual(batches(self.cluster.path("copy")), batches(self.cluster.path("b")))
        self.assertEqual(self.a.stop()[0], 0)

    def test_of_several_servers_one_takes_a_session_each_time(self):
        for name in ("b", "c"):
            self.cluster.start(name)
        sessions = ["block"] + [f"block{n}" for n in range(5)]
        for session in sessions[1:]:
            self.a.create(session, dict(SCENE, name=session))
        until(self, lambda: [(self.a.info(s)["copied"] or {"fault": ""})["fault"]
                             for s in sessions], [None] * len(sessions))
        epochs = {session: self.a.info(session)["epoch"] for session in sessions}
        self.cluster.stop("a", signal.SIGKILL)
        owners = {session: self.cluster.wait_for_owner(session) for session in sessions}
        for session, owner in owners.items():
            self.assertEqual(self.info(owner, session)["epoch"], epochs[session] + 1)
            self.assertEqual(self.cluster.owner(session), owner)
            other = self.cluster.servers["b" if owner == "c" else "c"]
            until(self, lambda s=session, o=other: o.http.request("GET", f"/v1/sessions/{s}")[0],
                  307)

    def test_a_server_that_stops_hands_over_and_its_peers_are_sent_on(self):
        b = self.cluster.start("b")
        self.wait_for_others(self.a, 1)
        agent = ClusterAgent(self.cluster)
        viewer = Viewer(self.a.port, "block")
        agent.move(300)
        self.assertEqual(self.cluster.stop("a")[0], 0)
        self.assertEqual(viewer.receive_json("bye")["redirect"], f"http://127.0.0.1:{b.port}")
        self.assertEqual(self.cluster.wait_for_owner(), "b")
        self.assertEqual(batches(self.cluster.path("a")), batches(self.cluster.path("b")))
        agent.move(50)
        agent.settle()
        self.assertEqual(self.block("b"), self.uninterrupted(350))
        # Its own journal is behind now: it is not opened, and replaced when the session comes back.
        self.a = self.cluster.start("a")
        self.assertEqual(self.cluster.owner(), "b")
        self.wait_for_others(b, 1)
        self.cluster.stop("b")
        self.assertEqual(self.cluster.wait_for_owner(), "a")
        self.assertEqual(self.block("a"), self.uninterrupted(350))
        self.assertFalse(os.path.exists(os.path.join(self.cluster.path("a"), "closed")))

    def test_without_nats_the_session_pauses_and_goes_on_by_itself(self):
        self.cluster.start("b")
        agent = ClusterAgent(self.cluster)
        agent.move(50)
        agent.settle()
        epoch = self.a.info()["epoch"]
        self.cluster.nats.stop(signal.SIGKILL)
        until(self, lambda: self.a.info()["paused"], "lease")
        self.assertEqual(self.a.http.json("GET", "/readyz")[1]["paused"], ["block"])
        status, answer = self.a.http.json("POST", "/v1/sessions?id=other",
                                          json.dumps(dict(SCENE, name="other")))
        self.assertEqual((status, answer["error"]["code"]), (503, "no_lease"))
        before = self.block("a")
        agent.move(16)
        self.assertEqual(self.block("a"), before)
        self.cluster.nats.start()
        owner = self.cluster.wait_for_owner()
        until(self, lambda: self.info(owner)["paused"], None)
        if owner == "a":
            self.assertEqual(self.info(owner)["epoch"], epoch)

    def test_any_server_lists_all_sessions_and_none_gets_a_second_one_of_an_id(self):
        b = self.cluster.start("b")
        b.create("other", dict(SCENE, name="other"))
        for server in (self.a, b):
            def listed(at=server):
                answer = at.http.json("GET", "/v1/sessions")[1]["sessions"]
                return sorted((s["id"], s["node"]) for s in answer)
            until(self, listed, [("block", "a"), ("other", "b")])
        again = "/v1/sessions?id=block&here=1"  # here: never at the one with fewer sessions
        status, answer = b.http.json("POST", again, json.dumps(SCENE))
        self.assertEqual((status, answer["error"]["code"]), (409, "session_exists"))
        socket = WebSocket(b.port, "/v1/sessions/block/view", "kerf.view.v1")
        self.assertEqual(socket.receive_json("bye")["redirect"], f"http://127.0.0.1:{self.a.port}")
        self.assertEqual(self.a.http.request("DELETE", "/v1/sessions/block")[0], 200)
        until(self, lambda: b.http.request("GET", "/v1/sessions/block")[0], 404)
        status, answer = b.http.json("POST", again, json.dumps(SCENE))
        self.assertEqual((status, answer["error"]["code"]), (503, "no_lease"))
        self.assertIn("kerf-server forget block", answer["error"]["reason"])

    def cut_until_snapshot(self, agent, server, record):
        """Cuts until a snapshot after that record, and then another one, are copied."""
        end = time.monotonic() + 60
        for _ in range(2):
            while (server.info()["copied"] or {"snapshot": 0})["snapshot"] <= record:
                self.assertLess(time.monotonic(), end, server.info()["copied"])
                agent.move(16)
            record = server.info()["copied"]["snapshot"]
        agent.settle()

    def test_a_takeover_begins_with_the_copied_snapshot_and_a_damaged_one_costs_only_time(self):
        self.cluster.stop("a")
        often = ("--snapshot-after", "0")  # each motion makes one due
        self.a = self.cluster.start("a", *often)
        self.assertEqual(self.cluster.wait_for_owner(), "a")
        agent = ClusterAgent(self.cluster)
        self.cut_until_snapshot(agent, self.a, 100)
        b = self.cluster.start("b", *often)
        self.cluster.stop("a", signal.SIGKILL)
        self.assertEqual(self.cluster.wait_for_owner(), "b")
        self.assertEqual(self.block("b"), self.uninterrupted(len(agent.sent)))
        for name in ("block.kerf-snapshot", "block.kerf-snapshot-previous"):
            self.assertTrue(os.path.exists(os.path.join(self.cluster.path("b"), name)), name)
        first = len(agent.sent)
        agent.move(16)
        self.cut_until_snapshot(agent, b, first)
        log = self.cluster.stop("b", signal.SIGKILL)[1]
        self.assertNotIn("snapshot was ignored", log)
        self.cluster.nats.request("kerf.snapshot.block", b"no snapshot")
        self.cluster.start("c")
        self.assertEqual(self.cluster.wait_for_owner(), "c")
        self.assertEqual(self.block("c"), self.uninterrupted(len(agent.sent)))
        log = self.cluster.stop("c")[1]
        self.assertIn("a snapshot of its copy cannot be used", log)

    def sessions(self, server):
        """The number of sessions on each server, as one of them lists them."""
        listed = server.http.json("GET", "/v1/sessions")[1]["sessions"]
        return {node: sum(s["node"] == node for s in listed) for node in "abc"}

    def test_a_new_session_goes_to_the_server_with_the_fewest(self):
        servers = {"a": self.a, "b": self.cluster.start("b"), "c": self.cluster.start("c")}
        self.wait_for_others(self.a, 2)
        counts = {"a": 1, "b": 0, "c": 0}
        for n in range(5):
            scene = json.dumps(dict(SCENE, name=f"new{n}"))
            status, headers, body = self.a.http.request(
                "POST", "/v1/sessions?here=0" if n == 0 else "/v1/sessions", scene)
            name = "a"
            if min(counts.values()) < counts["a"]:
                self.assertEqual((status, json.loads(body)["error"]["code"]), (307, "other_server"))
                place, _, path = headers["location"].removeprefix("http://").partition("/")
                name = next(n for n, s in servers.items() if place == f"127.0.0.1:{s.port}")
                self.assertEqual(counts[name], min(counts.values()), counts)
                self.assertIn("here=1", path)
                status, _, body = servers[name].http.request("POST", "/" + path, scene)
            self.assertEqual(status, 201, body)
            counts[name] += 1
            until(self, lambda: self.sessions(self.a), counts)
        self.assertEqual(counts, {"a": 2, "b": 2, "c": 2})
        # A page's script may not follow to another origin: it gets its session where it asks, and
        # so does a scene of files that were uploaded there.
        self.assertEqual(self.a.http.request("DELETE", "/v1/sessions/new1?purge=1")[0] // 100, 3)
        self.a.create("one")
        self.a.create("two")
        for n, headers in enumerate([{"Origin": f"http://127.0.0.1:{self.a.port}"}, {}]):
            status, _, body = self.a.http.request(
                "POST", "/v1/sessions", json.dumps(dict(SCENE, name=f"page{n}")), headers)
            self.assertEqual(status, 201 if headers else 307, body)

    def test_the_real_agent_goes_on_at_another_server(self):
        self.cluster.start("b")
        self.wait_for_others(self.a, 1)
        path = os.path.join(self.folder.name, "rows.csv")
        with open(path, "w", encoding="ascii") as file:
            file.write(rows(240.0))
        agent = subprocess.Popen(
            [AGENT, "--server", f"http://127.0.0.1:{self.a.port}", "--session", "block",
             "--name", "Ada", "--device", "replay:" + path, "--tool", "2", "--status-json", "-"],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        # With these records the copy has the agent, who could not resume otherwise.
        until(self, lambda: (self.a.info()["copied"] or {"record": 0})["record"] > 100, True)
        self.cluster.stop("a", signal.SIGKILL)
        out, log = agent.communicate(timeout=60)
        keep("agent", log)
        self.assertEqual(agent.returncode, 0, log)
        link = json.loads(out)["link"]
        self.assertEqual((link["unanswered"], link["not_durable"], link["given_up"],
                          link["resumed"], link["errors"]), (0, 0, 0, 1, {}), log)
        with tempfile.TemporaryDirectory(prefix="kerf-test-") as folder:
            whole = Server(folder)
            whole.create()
            subprocess.run([AGENT, "--server", f"http://127.0.0.1:{whole.port}", "--session",
                            "block", "--name", "Ada", "--device", "replay:" + path, "--tool", "2"],
                           check=True, capture_output=True, timeout=60)
            expected = whole.info()["state_hash"]
            whole.stop()
        self.assertEqual(self.info("b")["state_hash"], expected)


if __name__ == "__main__":
    if nats_server.PROGRAM is None:
        print("skipped: nats-server is not installed")
        sys.exit(77)
    run_tests()
