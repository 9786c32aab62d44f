# SPDX-License-Identifier: Apache-2.0
"""A real server whose disk is full, and one that finds journals it cannot read."""
import itertools
import json
import os
import resource
import signal
import sqlite3
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from kept_logs import run_tests  # noqa: E402
from live_server import SCENE, LiveTest, Server, until  # noqa: E402
from live_session_test import Agent, carve  # noqa: E402
from waiting import eventually  # noqa: E402
from wire_client import Viewer  # noqa: E402


class FullDisk(LiveTest):
    def limit_files(self, size):
        """Writes beyond `size` bytes fail; needs no privilege, unlike a small file system."""
        hard = resource.prlimit(self.server.process.pid, resource.RLIMIT_FSIZE)[1]
        resource.prlimit(self.server.process.pid, resource.RLIMIT_FSIZE,
                         (hard if size is None else size, hard))

    def ready(self):
        return self.server.http.json("GET", "/readyz")

    def metric(self, name):
        text = self.server.http.request("GET", "/metrics")[2].decode()
        return [line for line in text.splitlines() if line.startswith(name + "{")]

    def wait_for_failed_commits(self, count):
        """Waits until the session has tried so many times more to write."""
        def failed():
            return sum(int(line.split()[-1]) for line in self.metric("kerf_journal_failed_commits"))

        before = failed()
        until(self, lambda: failed() >= before + count, True)

    def test_session_pauses_and_continues_without_loss(self):
        agent, viewer = Agent(self.port, "block"), Viewer(self.port, "block")
        carve(agent, 200)
        self.assertEqual(self.ready(), (200, {"status": "ready", "loading": [], "paused": [],
                                              "damaged": [], "unreadable": []}))
        self.assertIsNone(self.server.info()["paused"])
        self.limit_files(0)
        # What was accepted before the failed commit stays in the block; then motions are rejected.
        agent.move([(0, 0, -6)])
        agent.result()
        places = itertools.count()

        def is_rejected():
            agent.move([(0.001 * next(places), 0, -6)])
            return agent.result()["status"] & 4

        # A commit before may wait for a slow disk.
        eventually(is_rejected, "motions are taken though the disk is full", 60, 0.002)
        agent.move([(0, 0.001, -6)])
        error = agent.receive_json("error")
        self.assertEqual(error["code"], "busy")
        self.assertIn("paused: disk: ", error["reason"])
        self.assertFalse(error["fatal"])
        status, body = self.ready()
        self.assertEqual((status, body["status"], body["paused"]), (503, "paused", ["block"]))
        self.assertEqual(self.server.http.request("GET", "/healthz")[0], 200)
        info = self.server.info()
        self.assertEqual(info["paused"], "disk")
        listed = self.server.http.json("GET", "/v1/sessions")[1]["sessions"][0]
        self.assertEqual(listed["paused"], "disk")
        self.assertEqual(self.metric("kerf_journal_paused"),
                         ['kerf_journal_paused{session="block"} 1'])
        while viewer.receive_json("state").get("paused") != "disk":
            pass
        self.wait_for_failed_commits(2)  # it tries again, and that is not logged again
        self.assertEqual(self.ready()[0], 503)
        self.limit_files(None)
        until(self, lambda: self.ready()[0], 200)
        while "paused" in viewer.receive_json("state"):
            pass
        carve(agent, 50, 1.0)
        expected = self.server.info()
        self.assertGreaterEqual(expected["motions"], info["motions"] + 49)
        self.assertIsNone(expected["paused"])
        until(self, lambda: self.server.info()["journal_lag"], 0)
        log = self.server.stop(signal.SIGKILL)[1]
        self.assertEqual(log.count("paused: disk"), 1, log)
        self.assertEqual(log.count("the session continues"), 1, log)
        self.server = Server(self.folder.name)
        found = self.server.info()
        self.assertEqual(found["state_hash"], expected["state_hash"])
        self.assertEqual(found["motions"], expected["motions"])

    def test_server_killed_while_paused_restarts_with_what_was_durable(self):
        agent = Agent(self.port, "block")
        carve(agent, 200)
        until(self, lambda: self.server.info()["journal_lag"], 0)
        durable = self.server.info()["motions"]
        self.limit_files(0)
        carve(agent, 100, 1.0)
        # The hash of a state beyond the durable one is asked for, and must not be stored alone.
        reached = self.server.info()["motions"]
        self.wait_for_failed_commits(2)
        self.server.stop(signal.SIGKILL)
        self.server = Server(self.folder.name)
        self.assertGreaterEqual(self.server.info()["motions"], durable)
        self.assertLessEqual(self.server.info()["motions"], reached)
        carve(Agent(self.server.port, "block"), 50)

    def test_session_is_loaded_when_a_disk_that_was_full_at_the_start_has_space(self):
        carve(Agent(self.port, "block"), 50)
        expected = self.server.hash()
        self.server.stop()
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
        self.assertEqual(self.server.hash(), expected)
        carve(Agent(self.server.port, "block"), 50)

    def test_stopped_while_paused_it_names_what_is_lost(self):
        agent = Agent(self.port, "block")
        carve(agent, 50)
        until(self, lambda: self.server.info()["journal_lag"], 0)
        self.limit_files(0)
        carve(agent, 50, 1.0)
        status, log = self.server.stop()
        self.assertEqual(status, 0, log)
        self.assertIn("the last records could not be written and are lost", log)
        self.server = Server(self.folder.name)
        self.assertGreaterEqual(self.server.info()["motions"], 49)


class DiskLimits(LiveTest):
    def test_limits_pause_sessions_and_closed_ones_make_space_and_come_back(self):
        agent = Agent(self.port, "block")
        carve(agent, 200)
        until(self, lambda: self.server.info()["journal_lag"], 0)
        expected = self.server.hash()
        self.server.stop()
        # Without the log of SQLite, which has as many bytes more as there were commits.
        journal_bytes = os.path.getsize(os.path.join(self.folder.name, "block.kerf"))
        limit = ["--disk-per-session", str(journal_bytes / 2e6)]
        self.server = Server(self.folder.name, *limit)
        until(self, lambda: self.server.info()["paused"], "disk")
        # A session at a limit of its own is no fault of the server.
        self.assertEqual(self.server.http.json("GET", "/readyz"), (200, {
            "status": "ready", "loading": [], "paused": ["block"], "damaged": [], "unreadable": []}))
        http = self.server.http
        # The limit of one session is not that of another, nor of the folder.
        self.server.create("second")
        carve(Agent(self.server.port, "second"), 20)
        self.assertEqual(http.json("DELETE", "/v1/sessions/block")[0], 200)
        closed = http.json("GET", "/v1/closed")[1]["closed"]
        self.assertEqual([entry["id"] for entry in closed], ["block"])
        name = closed[0]["name"]
        self.server.stop()
        self.server = Server(self.folder.name, "--disk-total", "0.001")
        http = self.server.http
        until(self, lambda: self.server.info("second")["paused"], "disk")
        self.assertEqual(http.json("GET", "/readyz")[0], 503)
        status, body = http.json("POST", "/v1/sessions?id=third", json.dumps(SCENE))
        self.assertEqual((status, body["error"]["code"]), (507, "disk_full"))
        self.assertIn("--disk-total", body["error"]["reason"])
        status, log = self.server.stop()
        self.assertEqual(log.count("paused: disk"), 1, log)
        self.server = Server(self.folder.name)
        http = self.server.http
        self.assertEqual(http.json("POST", f"/v1/closed/{name}"),
                         (201, {"id": "block", "url": "/v1/sessions/block", "recarved": False}))
        self.assertEqual(self.server.hash(), expected)
        self.assertEqual(http.json("POST", f"/v1/closed/{name}")[0], 404)
        self.assertEqual(http.json("DELETE", "/v1/closed/..%2Fblock")[0], 404)
        carve(Agent(self.server.port, "block"), 20)


    def test_downloads_end_before_sessions_are_paused(self):
        carve(Agent(self.port, "block"), 20)
        self.server.stop()
        space = os.statvfs(self.folder.name)
        free_mb = space.f_bavail * space.f_frsize / 1e6
        self.server = Server(self.folder.name, "--disk-reserve", str(0.7 * free_mb))
        http = self.server.http
        until(self, lambda: http.request("GET", "/v1/sessions/block/model.stl")[0], 507)
        error = http.json("GET", "/v1/sessions/block/model.stl")[1]["error"]
        self.assertEqual(error["code"], "disk_full")
        self.assertIn("--disk-reserve", error["reason"])
        carve(Agent(self.server.port, "block"), 20)
        self.assertIsNone(self.server.info()["paused"])
        self.assertEqual(http.json("GET", "/readyz")[0], 200)


class UnreadableJournals(LiveTest):
    def restart_with_scene(self):
        scene = os.path.join(self.folder.name, "scene.json")
        with open(scene, "w") as file:
            json.dump(SCENE, file)
        return Server(self.folder.name, "--scene", scene)

    def test_scene_option_does_not_stop_the_server_nor_overwrite_the_journal(self):
        self.server.create("other")
        carve(Agent(self.port, "block"), 50)
        self.server.stop()
        path = os.path.join(self.folder.name, "block.kerf")
        with sqlite3.connect(path) as journal:
            journal.execute("UPDATE batches SET bytes = zeroblob(7) "
                            "WHERE first = (SELECT max(first) FROM batches)")
        journal.close()
        with open(path, "rb") as file:
            before = file.read()
        self.server = self.restart_with_scene()
        status, body = self.server.http.json("GET", "/v1/sessions")
        self.assertEqual([s["id"] for s in body["sessions"]], ["other"])
        self.assertEqual([(s["id"], s["code"]) for s in body["unreadable"]],
                         [("block", "corrupt_journal")])
        status, body = self.server.http.json("GET", "/v1/sessions/block")
        self.assertEqual((status, body["error"]["code"]), (500, "unreadable_session"))
        status, body = self.server.http.json("POST", "/v1/sessions?id=block", json.dumps(SCENE))
        self.assertEqual((status, body["error"]["code"]), (409, "session_exists"))
        status, body = self.server.http.json("GET", "/readyz")
        self.assertEqual((status, body["unreadable"]), (200, ["block"]))
        code, log = self.server.stop()
        self.assertEqual(code, 0, log)
        self.assertIn("its journal stays as it is", log)
        with open(path, "rb") as file:
            self.assertEqual(file.read(), before)
        self.server = Server(self.folder.name)

    def test_hash_beyond_the_last_command_is_dropped_with_a_warning(self):
        carve(Agent(self.port, "block"), 50)
        expected = self.server.hash()
        self.server.stop()
        with sqlite3.connect(os.path.join(self.folder.name, "block.kerf")) as journal:
            journal.execute("INSERT INTO state_hashes VALUES(9999, 2989)")
        journal.close()
        self.server = self.restart_with_scene()
        self.assertEqual(self.server.hash(), expected)
        code, log = self.server.stop()
        self.assertEqual(code, 0, log)
        self.assertIn("session block: the journal ends after record", log)
        self.server = Server(self.folder.name)
        self.assertEqual(self.server.hash(), expected)
        self.assertNotIn("the journal ends after", self.server.stop()[1])


if __name__ == "__main__":
    run_tests()
