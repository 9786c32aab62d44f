# SPDX-License-Identifier: Apache-2.0
"""A real server whose disk is full: writes beyond a size fail, which needs no privilege."""
import itertools
import os
import resource
import signal
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from hands import carve  # noqa: E402
from kept_logs import run_tests  # noqa: E402
from live_server import LiveTest, Server, until  # noqa: E402
from waiting import eventually  # noqa: E402
from wire_client import Agent, Viewer  # noqa: E402


class FullDisk(LiveTest):
    def limit_files(self, size):
        hard = resource.prlimit(self.server.process.pid, resource.RLIMIT_FSIZE)[1]
        resource.prlimit(self.server.process.pid, resource.RLIMIT_FSIZE,
                         (hard if size is None else size, hard))

    def ready(self):
        return self.server.http.json("GET", "/readyz")

    def failed_commits(self):
        text = self.server.http.request("GET", "/metrics")[2].decode()
        return sum(int(line.split()[-1]) for line in text.splitlines()
                   if line.startswith("kerf_journal_failed_commits{"))

    def fill(self, agent):
        """Fills the disk; returns when motions are rejected."""
        self.limit_files(0)
        agent.move([(0, 0, -6)])
        agent.result()
        places = itertools.count()

        def is_rejected():
            agent.move([(0.001 * next(places), 0, -6)])
            return agent.result()["status"] & 4

        # An earlier commit may be waiting for a slow disk.
        eventually(is_rejected, "motions are taken though the disk is full", 60, 0.002)

    def test_a_session_pauses_continues_and_loses_nothing_that_was_durable(self):
        agent, viewer = Agent(self.port, "block"), Viewer(self.port, "block")
        carve(agent, 200)
        self.assertEqual(self.ready()[0], 200)
        self.fill(agent)
        agent.move([(0, 0.001, -6)])
        error = agent.receive_json("error")
        self.assertEqual((error["code"], error["fatal"]), ("busy", False))
        self.assertIn("paused: disk: ", error["reason"])
        status, body = self.ready()
        self.assertEqual((status, body["status"], body["paused"]), (503, "paused", ["block"]))
        self.assertEqual(self.server.http.request("GET", "/healthz")[0], 200)
        listed = self.server.http.json("GET", "/v1/sessions")[1]["sessions"][0]
        self.assertEqual((self.server.info()["paused"], listed["paused"]), ("disk", "disk"))
        while viewer.receive_json("state").get("paused") != "disk":
            pass
        # The server retries, but does not log that again.
        before = self.failed_commits()
        until(self, lambda: self.failed_commits() >= before + 2, True)
        motions = self.server.info()["motions"]
        self.limit_files(None)
        until(self, lambda: self.ready()[0], 200)
        while "paused" in viewer.receive_json("state"):
            pass
        carve(agent, 50, 1.0)
        expected = self.server.info()
        self.assertGreaterEqual(expected["motions"], motions + 49)
        self.assertIsNone(expected["paused"])
        until(self, lambda: self.server.info()["journal_lag"], 0)
        log = self.server.stop(signal.SIGKILL)[1]
        self.assertEqual(log.count("paused: disk"), 1, log)
        self.assertEqual(log.count("the session continues"), 1, log)

        # The disk is full at the start: the session is loaded once there is space.
        before = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (0, before[1]))
        try:
            self.server = Server(self.folder.name)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, before)
        listed = self.server.http.json("GET", "/v1/sessions")[1]
        self.assertEqual([(s["id"], s["code"]) for s in listed["unreadable"]],
                         [("block", "journal_io")])
        self.limit_files(None)
        until(self, lambda: self.ready()[1]["unreadable"], [])
        found = self.server.info()
        for figure in ("state_hash", "motions"):
            self.assertEqual(found[figure], expected[figure])

        # If killed while paused, the server continues with the durable records. If stopped, it
        # names the loss.
        durable = expected["motions"]
        for how in (signal.SIGKILL, signal.SIGTERM):
            self.fill(Agent(self.server.port, "block"))
            reached = self.server.info()["motions"]
            status, log = self.server.stop(how)
            if how == signal.SIGTERM:
                self.assertEqual(status, 0, log)
                self.assertIn("the last records could not be written and are lost", log)
            self.server = Server(self.folder.name)
            motions = self.server.info()["motions"]
            self.assertGreaterEqual(motions, durable)
            self.assertLessEqual(motions, reached)
        carve(Agent(self.server.port, "block"), 50)


if __name__ == "__main__":
    run_tests()
