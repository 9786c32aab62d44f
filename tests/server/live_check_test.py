# SPDX-License-Identifier: Apache-2.0
"""Snapshots of a real server, and the commands that verify its files."""
import itertools
import os
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from kept_logs import run_tests  # noqa: E402
from live_server import PROGRAM, LiveTest, Server, until  # noqa: E402
from live_session_test import Agent, carve  # noqa: E402
from waiting import eventually  # noqa: E402


def run(*words):
    done = subprocess.run([PROGRAM, *words], capture_output=True, text=True, timeout=60)
    return done.returncode, done.stdout + done.stderr


class Check(LiveTest):
    def setUp(self):
        super().setUp()
        self.journal = os.path.join(self.folder.name, "block.kerf")
        self.snapshot = self.journal + "-snapshot"
        self.previous = self.snapshot + "-previous"
        self.restart()

    def restart(self):
        if self.server.process.poll() is None:
            self.server.stop()
        self.server = Server(self.folder.name, "--snapshot-after", "0")

    def carved(self):
        carve(Agent(self.server.port, "block"), 300)
        until(self, lambda: os.path.exists(self.snapshot), True)
        agent = Agent(self.server.port, "block")
        phases = itertools.count()

        def has_next():  # which is written while the agent carves
            carve(agent, 30, phase=next(phases))
            return os.path.exists(self.previous)

        eventually(has_next, "no other snapshot is written", every_s=0.05)
        return self.server.info()

    def sql(self, text):
        with sqlite3.connect(self.journal) as journal:
            journal.execute(text)
        journal.close()

    def test_killed_server_goes_on_from_its_snapshot(self):
        expected = self.carved()
        until(self, lambda: self.server.info()["journal_lag"], 0)
        status, text = run("check", self.folder.name)  # beside the server
        self.assertEqual(status, 0, text)
        self.server.stop(signal.SIGKILL)
        self.restart()
        found = self.server.info()
        for figure in ("state_hash", "motions", "sub_motions", "removed_volume_mm3"):
            self.assertEqual(found[figure], expected[figure], figure)
        self.assertNotIn("ignored", self.server.stop()[1])
        # Nothing before it was read: only the whole journal is damaged.
        self.sql("UPDATE batches SET crc=crc+1 WHERE first=1")
        self.restart()
        self.assertEqual(self.server.hash(), expected["state_hash"])
        self.server.stop()
        for file in (self.snapshot, self.previous):
            os.remove(file)
        self.restart()
        self.assertEqual(self.server.http.json("GET", "/v1/sessions/block")[0], 500)

    def test_check_names_the_tables_whose_rows_are_damaged(self):
        self.carved()
        for path in ("versions?name=rough", "pins?text=here&at_mm=0,0,0&normal=0,0,1"):
            self.assertEqual(self.server.http.json("POST", "/v1/sessions/block/" + path)[0], 201)
        self.server.stop()
        self.assertEqual(run("check", self.folder.name)[0], 0)
        for table in ("versions", "pins"):
            self.sql(f"UPDATE {table} SET crc=crc+1")
            status, text = run("check", self.folder.name)
            self.assertEqual(status, 1, text)
            self.assertRegex(text, rf"the checksums of \d+ rows of {table} are wrong")
            self.sql(f"UPDATE {table} SET crc=crc-1")
        self.assertEqual(run("check", self.folder.name)[0], 0)

    def test_a_backup_of_a_running_server_serves_the_same_block(self):
        expected = self.carved()
        until(self, lambda: self.server.info()["journal_lag"], 0)
        to = os.path.join(self.folder.name, "copies")
        status, text = run("backup", self.folder.name, to)
        self.assertEqual((status, text), (0, os.path.join(to, "block.kerf") + "\n"))
        carve(Agent(self.server.port, "block"), 50, phase=1.0)  # the server goes on
        status, text = run("check", to)
        self.assertEqual(status, 0, text)
        copy = Server(to)
        self.addCleanup(copy.stop)
        self.assertEqual(copy.hash(), expected["state_hash"])
        for file in (self.snapshot, self.previous):
            self.assertTrue(os.path.exists(os.path.join(to, os.path.basename(file))))
        status, text = run("backup", self.folder.name, to)
        self.assertEqual(status, 1)
        self.assertIn("block.kerf", text)
        status, text = run("backup", os.path.join(self.folder.name, "missing"), to)
        self.assertEqual(status, 1)

    def test_damage_below_a_snapshot_is_reported_and_the_rest_is_salvaged(self):
        self.carved()
        self.restart()  # from here on records can be read without those before
        carve(Agent(self.server.port, "block"), 50, phase=1.0)
        until(self, lambda: self.server.info()["journal_lag"], 0)
        expected = self.server.hash()
        self.server.stop()
        second = "(SELECT first FROM batches ORDER BY first LIMIT 1 OFFSET 1)"
        self.sql(f"UPDATE batches SET crc=crc+1 WHERE first={second}")
        self.restart()
        self.assertEqual(self.server.hash(), expected)
        ready = lambda: self.server.http.json("GET", "/readyz")  # noqa: E731
        until(self, lambda: ready()[1].get("damaged"), ["block"])
        self.assertEqual(ready()[0], 200)
        status, answer = self.server.http.json("POST", "/v1/sessions/block/undo?participant=1")
        self.assertEqual((status, answer["error"]["code"]), (500, "damaged_journal"))
        status, text = run("backup", self.folder.name, os.path.join(self.folder.name, "copies"))
        self.assertEqual(status, 1, text)
        self.assertIn("block.kerf is damaged, and was copied as it is", text)
        for folder, _, files in os.walk(self.folder.name):
            for file in files:
                self.assertEqual(os.stat(os.path.join(folder, file)).st_mode & 0o077, 0, file)
        self.assertEqual(self.server.stop()[1].count("corrupt_journal"), 1)
        out = os.path.join(self.folder.name, "out")
        status, text = run("salvage", self.journal, out)
        self.assertEqual(status, 0, text)
        self.assertIn("kept: the block after record", text)
        for file in (self.journal, self.snapshot, self.previous):
            os.remove(file)
        os.rename(out, self.journal)
        self.restart()
        self.assertEqual(self.server.hash(), expected)

    def test_closed_sessions_are_checked_and_backed_up_too(self):
        expected = self.carved()["state_hash"]
        self.assertEqual(self.server.http.json("DELETE", "/v1/sessions/block")[0], 200)
        name = self.server.http.json("GET", "/v1/closed")[1]["closed"][0]["name"]
        to = os.path.join(self.folder.name, "copies")
        status, text = run("backup", self.folder.name, to)
        self.assertEqual((status, text), (0, os.path.join(to, "closed", name + ".kerf") + "\n"))
        status, text = run("check", to)
        self.assertEqual(status, 0, text)
        self.assertIn(f"closed/{name}.kerf: good", text)
        copy = Server(to)
        self.addCleanup(copy.stop)
        self.assertEqual(copy.http.json("POST", f"/v1/closed/{name}")[0], 201)
        self.assertEqual(copy.hash(), expected)
        with open(os.path.join(to, "closed", "broken.kerf"), "w") as file:
            file.write("nonsense")
        status, text = run("check", to)
        self.assertEqual(status, 1)
        self.assertIn("closed/broken.kerf: ", text)

    def test_good_files_pass_and_a_replay_compares_hashes_and_snapshot(self):
        self.carved()
        self.server.hash()
        self.server.stop()
        status, text = run("check", self.folder.name)
        self.assertEqual(status, 0, text)
        self.assertEqual([line.split(":")[0] for line in text.splitlines()],
                         ["block.kerf", "block.kerf-snapshot", "block.kerf-snapshot-previous"])
        self.assertEqual(text.count(": good"), 3)
        status, text = run("replay", self.journal)
        self.assertEqual(status, 0, text)
        self.assertIn("and two snapshots", text)

    def test_faults_are_named_with_what_to_do(self):
        expected = self.carved()["state_hash"]
        self.server.stop()
        with open(self.snapshot, "r+b") as file:
            file.truncate(os.path.getsize(self.snapshot) - 1)
        status, text = run("check", self.folder.name)
        self.assertEqual(status, 1)
        self.assertIn("block.kerf: good", text)
        self.assertIn("block.kerf-snapshot: it is truncated -> delete it", text)
        self.restart()
        self.assertEqual(self.server.hash(), expected)
        log = self.server.stop()[1]
        self.assertRegex(log, "session block: its snapshot was ignored: it is truncated; "
                              r"the one before it, after record \d+, was used")
        # A hash that no replay gives, of the last record.
        self.sql("INSERT OR REPLACE INTO state_hashes SELECT max(first+count)-1, 2989 FROM batches")
        status, text = run("replay", self.journal)
        self.assertEqual(status, 1)
        self.assertRegex(text, r"differs: record \d+ of participant \d+ at 20\d\d-.*Z: replay gives")
        self.sql("UPDATE batches SET bytes=zeroblob(7) WHERE first=(SELECT max(first) FROM batches)")
        status, text = run("check", self.folder.name)
        self.assertEqual(status, 1)
        self.assertRegex(text, r"block.kerf: corrupt_journal: record \d+: .* -> restore a copy")
        self.assertEqual(run("replay", self.journal)[0], 1)
        self.assertEqual(run("check", os.path.join(self.folder.name, "none"))[0], 1)
        self.sql("PRAGMA user_version=77")
        self.assertRegex(run("check", self.folder.name)[1],
                         "(?m)^block.kerf-snapshot-previous: its journal cannot be read -> keep it")
        os.remove(self.journal)
        self.assertIn("there is no journal block.kerf", run("check", self.folder.name)[1])
        for file in (self.snapshot, self.previous):
            os.remove(file)
        self.server = Server(self.folder.name)

    def test_a_folder_of_no_server_is_no_good_one(self):
        with tempfile.TemporaryDirectory() as other:
            for words in (("check", other), ("backup", other, os.path.join(other, "to"))):
                status, text = run(*words)
                self.assertEqual(status, 1, text)
                self.assertIn("no server has used this folder", text)
                self.assertEqual(os.listdir(other), [])
        self.assertEqual(self.server.http.json("DELETE", "/v1/sessions/block?purge=1")[0], 200)
        self.assertEqual(run("check", self.folder.name), (0, ""))  # a server without sessions

    def test_a_damaged_page_is_found_in_any_table(self):
        self.server.stop()
        with sqlite3.connect(self.journal) as journal:
            page = journal.execute(
                "SELECT rootpage FROM sqlite_master WHERE name='program_lines'").fetchone()[0]
            size = journal.execute("PRAGMA page_size").fetchone()[0]
        journal.close()
        self.assertEqual(run("check", self.folder.name)[0], 0)
        with open(self.journal, "r+b") as file:
            file.seek((page - 1) * size)
            file.write(b"\xff" * size)
        status, text = run("check", self.folder.name)
        self.assertEqual(status, 1, text)
        self.assertRegex(text, r"block.kerf: corrupt_journal: .*age .* -> restore a copy")

    def test_copies_on_a_medium_that_cannot_be_written_are_read(self):
        self.carved()
        self.server.stop()
        mount = 'mount --bind "$1" "$1" && mount -o remount,bind,ro "$1" && exec "$0" "$2" "$3" $4'
        other = tempfile.TemporaryDirectory()
        self.addCleanup(other.cleanup)
        odd = os.path.join(other.name, "100% of #1?")
        shutil.copytree(self.folder.name, odd)
        for words in (("check", odd), ("replay", os.path.join(odd, "block.kerf")),
                      ("backup", odd, os.path.join(other.name, "to"))):
            done = subprocess.run(["unshare", "--user", "--map-root-user", "--mount", "sh", "-c", mount,
                                   PROGRAM, odd, *words], capture_output=True, text=True, timeout=60)
            if "unshare" in done.stderr:
                self.skipTest("this machine permits no mounts of one's own: " + done.stderr)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(run("check", os.path.join(other.name, "to"))[0], 0)
        self.server = Server(self.folder.name)


if __name__ == "__main__":
    run_tests()
