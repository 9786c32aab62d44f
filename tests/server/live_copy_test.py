# SPDX-License-Identifier: Apache-2.0
"""Journals are copied to NATS while they are written, and continued from there."""
import json
import os
import random
import shutil
import signal
import sqlite3
import struct
import subprocess
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import nats_server  # noqa: E402
from kept_logs import run_tests  # noqa: E402
from live_resume_test import DurableAgent  # noqa: E402
from live_server import PROGRAM, SCENE, FolderTest, Server, until  # noqa: E402


def run(*words):
    done = subprocess.run([PROGRAM, *words], capture_output=True, text=True, timeout=120)
    return done.returncode, done.stdout, done.stderr


def batches(folder, session="block"):
    """The rows of a journal's records."""
    with sqlite3.connect(os.path.join(folder, session + ".kerf")) as database:
        return database.execute("SELECT * FROM batches ORDER BY first").fetchall()


def is_copied_to(info, record):
    """Whether the copy goes up to a record, and goes on."""
    copied = info["copied"]  # null right after a start
    return copied is not None and (copied["record"], copied["fault"]) == (record, None)


def sphere(rings):
    """A binary STL file of 2 * rings * rings triangles."""
    from math import cos, pi, sin

    def point(i, j):
        a, b = pi * i / rings, 2 * pi * (j % rings) / rings
        if i in (0, rings):
            return 0.0, 0.0, 8.0 - 16.0 * (i == rings)
        return 8 * sin(a) * cos(b), 8 * sin(a) * sin(b), 8 * cos(a)

    facets = []
    for i in range(rings):
        for j in range(rings):
            p, q, r, s = point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)
            if i + 1 < rings:
                facets.append((p, q, r))
            if i > 0:
                facets.append((p, r, s))
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *a, *b, *c, 0) for a, b, c in facets)
    return bytes(80) + struct.pack("<I", len(facets)) + body


class Copy(FolderTest):
    def first_server(self):
        self.nats = nats_server.Nats(self.path("nats"))
        self.addCleanup(self.nats.stop)
        return self.start("a")

    def path(self, name):
        path = os.path.join(self.folder.name, name)
        os.makedirs(path, exist_ok=True)
        return path

    def start(self, name, *more):
        server = Server(self.path(name), "--nats", self.nats.url, *more)
        self.addCleanup(server.process.kill)  # of a test that has failed
        return server

    def copied(self, server=None, session="block"):
        return (server or self.server).info(session)["copied"]

    def fault(self, server=None):
        """Why nothing is copied; empty right after the start of a server."""
        return (self.copied(server) or {}).get("fault") or ""

    def wait_for_copy(self, server=None, session="block"):
        """Waits until everything is copied; returns the last record."""
        server = server or self.server
        last = None

        def is_whole():
            nonlocal last
            info = server.info(session)
            last = info["state_sequence"]
            return info["journal_lag"] == 0 and is_copied_to(info, last)

        until(self, is_whole, True)
        return last

    def fetch(self, name, session="block"):
        """Fetches the copy into a data folder of its own."""
        folder = self.path(name)
        status, _, error = run("--nats", self.nats.url, "fetch", session,
                               os.path.join(folder, session + ".kerf"))
        self.assertEqual(status, 0, error)
        return folder

    def test_another_machine_continues_after_a_kill_and_the_agent_resumes(self):
        self.server.create("whole")
        whole = DurableAgent(self.server.port, "whole")
        whole.move(600)
        expected = self.server.info("whole")
        agent = DurableAgent(self.server.port, "block")
        agent.move(400)
        self.wait_for_copy()
        copied = self.copied()["record"]
        self.server.stop(signal.SIGKILL)
        folder = self.fetch("b")
        self.assertEqual(batches(folder), batches(self.path("a")))
        self.assertEqual(run("replay", os.path.join(folder, "block.kerf"))[0], 0)
        self.server = self.start("b")
        self.assertGreaterEqual(self.server.info()["state_sequence"], copied)
        agent.connect(self.server.port)
        self.assertTrue(agent.welcome["resume"]["resumed"])
        self.assertEqual(agent.welcome["participant"], 1)
        self.assertEqual(self.server.info()["epoch"], 3)
        agent.move(200)
        info = self.server.info()
        self.assertEqual((info["motions"], info["state_hash"]),
                         (expected["motions"], expected["state_hash"]))
        self.wait_for_copy()
        again = self.fetch("c")
        self.assertEqual(batches(again), batches(self.path("b")))

    def test_what_was_stated_as_copied_is_in_the_copy_after_kills_at_any_moment(self):
        self.wait_for_copy()  # before it there is nothing to fetch
        seed = random.randrange(1 << 30)
        chance = random.Random(seed)
        for kill in range(5):
            agent = DurableAgent(self.server.port, "block")
            for _ in range(chance.randrange(2, 12)):
                agent.move(chance.randrange(1, 120))
            stated = (self.copied() or {"record": 0})["record"]  # null right after a start
            self.server.stop(signal.SIGKILL)
            folder = self.fetch(f"copy{kill}")
            copy, journal = batches(folder), batches(self.path("a"))
            self.assertEqual(copy, journal[:len(copy)], f"seed {seed}")
            # A server that is killed early has copied the journal without any record.
            last = copy[-1][0] + copy[-1][1] - 1 if copy else 0
            self.assertGreaterEqual(last, stated, f"seed {seed}")
            self.assertEqual(run("check", folder)[0], 0, f"seed {seed}")
            self.server = self.start("a")
        self.wait_for_copy()
        self.assertEqual(batches(self.fetch("last")), batches(self.path("a")))

    def test_a_restart_of_nats_loses_nothing(self):
        agent = DurableAgent(self.server.port, "block")
        agent.move(100)
        self.wait_for_copy()
        self.nats.stop(signal.SIGKILL)
        for _ in range(10):
            agent.move(50)  # answered as before
        until(self, lambda: "cannot be reached" in self.fault(), True)
        behind = self.copied()["record"]
        self.nats.start()
        self.assertGreater(self.wait_for_copy(), behind)
        self.assertEqual(batches(self.fetch("b")), batches(self.path("a")))

    def test_messages_that_nats_has_lost_are_sent_again(self):
        agent = DurableAgent(self.server.port, "block")
        agent.move(200)
        self.wait_for_copy()
        self.nats.stop()
        shutil.copytree(self.nats.folder, self.path("old"), dirs_exist_ok=True)
        self.nats.start()
        agent.move(200)
        self.wait_for_copy()
        self.nats.stop()
        shutil.rmtree(self.nats.folder)
        shutil.copytree(self.path("old"), self.nats.folder)
        self.nats.start()
        agent.move(50)
        self.wait_for_copy()
        self.assertEqual(batches(self.fetch("b")), batches(self.path("a")))

    def test_a_former_server_cannot_change_the_copy(self):
        agent = DurableAgent(self.server.port, "block")
        agent.move(100)
        self.wait_for_copy()
        former = self.server
        former.process.send_signal(signal.SIGSTOP)
        try:
            self.fetch("b")
            self.server = self.start("b")
            other = DurableAgent(self.server.port, "block")
            other.move(50)
            self.wait_for_copy()
        finally:
            former.process.send_signal(signal.SIGCONT)
        agent.move(100)  # on the former one, which does not know
        until(self, lambda: "another server continues" in self.fault(former), True)
        other.move(50)
        self.wait_for_copy()
        self.assertEqual(batches(self.fetch("c")), batches(self.path("b")))
        self.assertEqual(former.stop()[0], 0)
        for reason in ("another server continues", "records that this journal does not have"):
            again = self.start("a")  # of a greater epoch each time
            try:
                until(self, lambda: reason in self.fault(again), True)
            finally:
                self.assertEqual(again.stop()[0], 0)
        self.assertEqual(batches(self.fetch("d")), batches(self.path("b")))

    def test_server_starts_without_nats_and_copies_when_it_is_there(self):
        self.assertEqual(self.server.stop()[0], 0)
        self.nats.stop()
        self.server = self.start("a")
        agent = DurableAgent(self.server.port, "block")
        agent.move(100)
        until(self, lambda: "cannot be reached" in self.fault(), True)
        self.nats.start()
        self.wait_for_copy()
        self.assertEqual(batches(self.fetch("b")), batches(self.path("a")))

    def test_a_stopped_server_has_copied_everything(self):
        agent = DurableAgent(self.server.port, "block")
        agent.move(300)
        self.assertEqual(self.server.stop()[0], 0)
        self.assertEqual(batches(self.fetch("b")), batches(self.path("a")))

    def test_files_that_are_larger_than_a_message_are_copied(self):
        mesh = sphere(120)
        self.assertGreater(len(mesh), 1 << 20)
        status, body = self.server.http.json("POST", "/v1/files?name=ball.stl", mesh)
        self.assertEqual(status, 201, body)
        scene = dict(SCENE, name="ball", stock={"shape": "mesh", "file": body["file"]})
        self.server.create("ball", scene)
        self.wait_for_copy(session="ball")
        folder = self.fetch("b", "ball")
        expected = self.server.hash("ball")
        other = Server(folder)
        try:
            self.assertEqual(other.hash("ball"), expected)
        finally:
            self.assertEqual(other.stop()[0], 0)

    def test_copies_are_listed_and_forgotten(self):
        last = self.wait_for_copy()
        self.assertEqual(run("--nats", self.nats.url, "copies"),
                         (0, f"block: {last} records, epoch {self.server.info()['epoch']}\n", ""))
        self.assertEqual(self.server.stop()[0], 0)
        self.assertEqual(run("forget", "block", "--nats", self.nats.url)[0], 0)
        status, _, error = run("fetch", "block", self.path("b") + "/block.kerf", "--nats",
                               self.nats.url)
        self.assertEqual(status, 1)
        self.assertIn("there is no copy of session block", error)
        self.assertEqual(run("--nats", self.nats.url, "copies"), (0, "", ""))
        self.assertEqual(os.listdir(self.path("b")), [])

    def test_a_snapshot_is_fetched_with_the_journal_and_forgotten_with_it(self):
        self.server.stop()
        self.server = self.start("a", "--snapshot-after", "0")  # each motion makes one due
        agent = DurableAgent(self.server.port, "block")

        def copied_snapshot():
            agent.move(16)
            return (self.copied() or {"snapshot": 0})["snapshot"] > 0

        until(self, copied_snapshot, True)
        self.wait_for_copy()
        expected = self.server.hash()
        self.server.stop(signal.SIGKILL)
        folder = self.fetch("b")
        self.assertTrue(os.path.exists(os.path.join(folder, "block.kerf-snapshot")))
        status, out, error = run("check", folder)
        self.assertEqual((status, error), (0, ""), out)
        self.server = self.start("b")
        self.assertEqual(self.server.hash(), expected)
        self.server.stop()
        self.assertGreater(self.nats.bytes_of("KERF_SNAPSHOT_block"), 0)
        self.assertEqual(run("forget", "block", "--nats", self.nats.url)[0], 0)
        self.assertEqual(self.nats.bytes_of("KERF_SNAPSHOT_block"), 0)
        self.assertEqual(run("--nats", self.nats.url, "copies"), (0, "", ""))

    def test_any_server_of_a_list_serves_and_no_password_is_shown(self):
        last = self.wait_for_copy()
        away = f"nats://ada:secret@127.0.0.1:{nats_server.free_port()}"
        self.assertEqual(run("--nats", f"{away},{self.nats.url}", "copies"),
                         (0, f"block: {last} records, epoch {self.server.info()['epoch']}\n", ""))
        status, _, error = run("--nats", away, "copies")
        self.assertEqual((status, "NATS cannot be reached" in error), (1, True), error)
        self.assertNotIn("secret", error)
        status, _, error = run("--nats", "127.0.0.1:4222", "copies")
        self.assertNotEqual(status, 0)
        self.assertIn("must be nats://HOST:PORT", error)

    def test_metrics_state_the_copy(self):
        last = self.wait_for_copy()
        text = self.server.http.request("GET", "/metrics")[2].decode()
        self.assertIn(f'kerf_copied_record{{session="block"}} {last}\n', text)
        snapshot = self.copied()["snapshot"]
        self.assertIn(f'kerf_copied_snapshot_record{{session="block"}} {snapshot}\n', text)
        self.assertIn('kerf_copy_lag_records{session="block"} 0\n', text)

    def test_without_the_option_nothing_is_copied(self):
        plain = Server(self.path("plain"))
        plain.create()
        self.assertIsNone(self.copied(plain))
        self.assertNotIn(b"kerf_copied_record", plain.http.request("GET", "/metrics")[2])
        self.assertEqual(plain.stop()[0], 0)
        self.wait_for_copy()
        self.assertNotIn("plain", json.dumps(run("--nats", self.nats.url, "copies")))


if __name__ == "__main__":
    if nats_server.PROGRAM is None:
        print("skipped: nats-server is not installed")
        sys.exit(77)
    run_tests()
