# SPDX-License-Identifier: Apache-2.0
"""Tests recordings and studies of the real kerf-agent with the real server: kerf-agent --record,
export, replay of a recording, feel, --mode paper and --study."""
import csv
import io
import json
import os
import re
import signal
import subprocess
import threading

from kept_logs import keep, path_of, run_tests
from live_server import SCENE, LiveTest
from machine_stalls import succeeds
from waiting import eventually

AGENT = os.environ["KERF_AGENT"]
# Trips of a loop of 1 kHz that a busy machine causes.
BUSY_MACHINE = ("lost_ticks", "lost_ticks_in_a_row")
LIMIT_S = 120  # only ends a failed test


class RecordTest(LiveTest):
    def file(self, name):
        return os.path.join(self.folder.name, name)

    def words(self, *words, session="block"):
        return [AGENT, "--server", f"http://127.0.0.1:{self.port}", "--session", session, *words]

    def run_agent(self, *words, session="block", code=0, keys=None):
        """Waits until the agent exits; returns its summary."""
        where = self.file(f"{session}.json")
        done = subprocess.run([*self.words(*words, session=session), "--status-json", where],
                              capture_output=True, text=True, timeout=LIMIT_S, input=keys)
        keep("agent", done.stderr)
        self.assertEqual(done.returncode, code, done.stderr)
        if code != 0:
            return done.stderr
        with open(where) as file:
            return json.load(file)

    def export(self, recording):
        done = subprocess.run([AGENT, "export", recording], capture_output=True, text=True,
                              timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        return list(csv.DictReader(io.StringIO(done.stdout)))

    def test_a_recording_has_every_tick_and_replays_to_the_same_block(self):
        file = self.file("carved.mcap")
        words = ("--device", "sim", "--duration", "3")
        status = self.run_agent(*words, "--record", file)
        record = status["record"]
        self.assertEqual((record["lost"], record["error"]), (0, ""))
        self.assertEqual(record["ticks"], status["servo"]["ticks"])
        rows = self.export(file)
        self.assertEqual(len(rows), record["ticks"])
        most = max(sum(float(row[f"felt_f{i}_n"]) ** 2 for i in "xyz") ** 0.5 for row in rows)
        self.assertAlmostEqual(most, status["force"]["max_n"], delta=1e-6)
        # Never overwritten; the error says so before anything is carved.
        self.assertIn("exists; choose another name",
                      self.run_agent(*words, "--record", file, code=1))
        # The replay reads its pose between the ticks' times, so the volume is equal, not the bytes.
        self.server.create("again", SCENE)
        self.run_agent("--device", "replay:" + file, session="again")
        removed = [self.server.info(name)["removed_volume_mm3"] for name in ("block", "again")]
        self.assertGreater(removed[0], 1)
        self.assertAlmostEqual(removed[1], removed[0], delta=0.02 * removed[0])

    def test_a_killed_agent_leaves_its_recording_up_to_the_last_chunk(self):
        file = self.file("killed.mcap")
        with open(path_of("agent"), "w") as log:
            agent = subprocess.Popen(self.words("--device", "sim", "--loop", "--record", file),
                                     stdout=subprocess.DEVNULL, stderr=log)
        self.addCleanup(agent.wait)
        self.addCleanup(agent.kill)

        def is_long():
            self.assertIsNone(agent.poll(), "the agent has ended before it was killed")
            return os.path.exists(file) and os.path.getsize(file) >= 200_000

        eventually(is_long, "the recording does not grow", LIMIT_S)
        agent.send_signal(signal.SIGKILL)
        agent.wait()
        rows = self.export(file)
        self.assertGreater(len(rows), 500)
        self.assertEqual(set(row["has_pose"] for row in rows), {"1"})

    def has_tripped(self, trips, last):
        """Whether the safety envelope has tripped, which only a busy machine may cause here."""
        if trips > 0:
            self.assertIn(last, BUSY_MACHINE)
        return trips > 0

    def feel(self, number):
        """Records a stroke and feels it; returns whether neither run has tripped."""
        name = f"attempt-{number}"
        self.server.create(name, SCENE)
        file, felt = self.file(name + ".mcap"), self.file(name + "-felt.mcap")
        status = self.run_agent("--device", "sim", "--duration", "6", "--record", file,
                                session=name)
        if self.has_tripped(status["safety"]["trips"], status["safety"]["last_trip"]):
            return False
        self.assertGreater(status["force"]["felt"]["ticks"], 500)
        done = subprocess.run([AGENT, "feel", file, "--device", "sim", "--record", felt],
                              capture_output=True, text=True, timeout=LIMIT_S)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("felt     ", done.stdout)
        rows = self.export(felt)
        self.assertEqual(set(row["mode"] for row in rows), {"silent"})
        trips, last = re.search(r"safety   (\d+) trips(?:, last: (\w+))?", done.stdout).groups()
        if self.has_tripped(int(trips), last):
            return False
        most = max(abs(float(row["felt_fx_n"])) + abs(float(row["felt_fy_n"])) for row in rows)
        self.assertGreater(most, 0.05, "the recorded force is felt")
        return True

    def test_a_recording_is_felt_without_a_server(self):
        self.assertTrue(succeeds(self, self.feel), "lost ticks on a machine that was not busy")

    def test_the_papers_loop_is_answered_by_the_replica_and_recorded_as_paper(self):
        file = self.file("paper.mcap")
        status = self.run_agent("--device", "sim", "--duration", "4", "--mode", "paper",
                                "--record", file)
        self.assertGreater(status["copy"]["felt_ticks"], 100, "the replica answers")
        self.assertEqual(set(row["mode"] for row in self.export(file)), {"paper"})

    def test_a_study_writes_a_line_for_each_answer(self):
        file = self.file("study.csv")
        agent = subprocess.Popen(
            self.words("--device", "sim", "--loop", "--study", file, "--trials", "2",
                       "--interval", "1", "--seed", "4"),
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        limit = threading.Timer(LIMIT_S, agent.kill)
        limit.start()
        self.addCleanup(limit.cancel)
        for line in agent.stderr:
            if "a or b?" in line:
                agent.stdin.write("a\n")
                agent.stdin.flush()
        output = agent.stdout.read()
        agent.communicate()
        self.assertEqual(agent.returncode, 0, output)
        with open(file) as table:
            rows = list(csv.DictReader(table))
        self.assertEqual([row["trial"] for row in rows], ["1", "2"])
        for row in rows:
            self.assertEqual({row["mode_a"], row["mode_b"]}, {"kerf", "paper"})
            self.assertEqual(row["correct"], "1" if row["mode_a"] == "kerf" else "0")
            self.assertGreaterEqual(float(row["reaction_s"]), 0)
        right = sum(int(row["correct"]) for row in rows)
        self.assertIn(f"2 trials in {file}, {right} named Kerf's loop", output)


if __name__ == "__main__":
    run_tests()
