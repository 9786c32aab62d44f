# SPDX-License-Identifier: Apache-2.0
"""Tests the real kerf-agent with the real server: a slow line, two devices, a study and recordings."""
import csv
import io
import json
import os
import signal
import subprocess
import threading

from delaying_relay import Line, Relay
from kept_logs import keep, path_of, run_tests
from live_server import SCENE, LiveTest, until
from waiting import eventually

AGENT = os.environ["KERF_AGENT"]
# Round trip and stalls of a bad connection to another continent.
FAR = Line(rtt_s=0.1, jitter=0.2, loss=0.05, stall_s=0.2)
MILL = 2
LIMIT_S = 120  # reached by a failed test only


def table(poses):
    """Returns the text of a pose file from tuples (seconds, tip, cutting)."""
    lines = ["t_s,x,y,z,i,j,k,cutting"]
    for time_s, tip, cutting in poses:
        lines.append(",".join(f"{n:.9g}" for n in (time_s, *tip, 0, 0, 1)) + f",{int(cutting)}")
    return "\n".join(lines) + "\n"


def rows(mm_per_s=60.0):
    """Straight cuts with a flat mill, all turns in the air. The result does not depend on the positions
    of the samples along them, so it is bitwise equal for every line."""
    time_s, poses = 0.5, [(0, (-40, -12, -2), False)]
    for i, y in enumerate((-12, -6, 1, 7)):
        ends = (-40, 40) if i % 2 == 0 else (40, -40)
        poses.append((time_s, (ends[0], y, -2 - i), False))
        time_s += 80 / mm_per_s
        poses.append((time_s, (ends[1], y, -2 - i), True))
        time_s += 0.2
    return table(poses)


class AgentTest(LiveTest):
    def file(self, name):
        return os.path.join(self.folder.name, name)

    def words(self, *words, session="block", port=None):
        url = f"http://127.0.0.1:{port or self.port}"
        return [AGENT, "--server", url, "--session", session, *words]

    def start(self, *words):
        with open(path_of("agent"), "w") as log:
            process = subprocess.Popen(self.words(*words), stdout=subprocess.PIPE, stderr=log,
                                       text=True)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def run_agent(self, *words, session="block", port=None, code=0):
        """Waits until the agent exits; returns its summary, or why it failed."""
        where = self.file(f"{session}.json")
        done = subprocess.run(
            self.words(*words, "--status-json", where, session=session, port=port),
            capture_output=True, text=True, timeout=LIMIT_S)
        keep("agent", done.stderr)
        self.assertEqual(done.returncode, code, done.stderr)
        if code != 0:
            return done.stderr
        with open(where) as file:
            return json.load(file)


class ThroughASlowLine(AgentTest):
    def check_arrived(self, status, info):
        """Checks that every sample was answered, on one connection."""
        link = status["link"]
        self.assertEqual((link["unanswered"], link["rejected_results"], link["bad_frames"]),
                         (0, 0, 0))
        self.assertEqual((link["connections"], link["forgotten"], link["errors"]), (1, 0, {}))
        self.assertGreater(link["results"], 0)
        removed = info["removed_volume_mm3"]
        self.assertGreater(removed, 10)
        self.assertAlmostEqual(status["removed_mm3"], removed, delta=removed * 1e-4)

    def check_line(self, relay, status):
        """Checks the delay of the line; no upper limit, which a loaded machine might exceed."""
        self.assertGreaterEqual(status["link"]["ping_us"]["p50"],
                                FAR.rtt_s * (1 - FAR.jitter) * 1e6)
        for direction in (relay.up, relay.down):
            self.assertGreater(direction.pieces, 100)
            self.assertGreater(direction.lost, 0)
            self.assertGreater(direction.stalled, 0)

    def test_the_carved_block_is_bitwise_equal(self):
        with open(self.file("path.csv"), "w") as file:
            file.write(rows(120.0))
        words = ("--tool", str(MILL), "--device", "replay:" + self.file("path.csv"))
        self.check_arrived(self.run_agent(*words), self.server.info())
        self.server.create("far", SCENE)
        with Relay(self.port, FAR) as relay:
            status = self.run_agent(*words, session="far", port=relay.port)
        self.check_line(relay, status)
        self.check_arrived(status, self.server.info("far"))
        self.assertEqual(self.server.hash("far"), self.server.hash())


class TwoDevices(AgentTest):
    def test_two_devices_carve_as_two_participants_and_one_signal_makes_both_leave(self):
        process = self.start("--name", "Ada", "--loop", "--device", "sim", "--device", "sim",
                             "--status-json", self.file("hand.json"))
        until(self, lambda: {person["name"] for person in self.server.info()["participants"]},
              {"Ada", "Ada 2"})
        until(self, lambda: self.server.info()["removed_volume_mm3"] > 10, True)
        process.send_signal(signal.SIGINT)
        self.assertEqual((process.wait(60), process.communicate()[0].count("carved")), (0, 2))
        summaries = []
        for name in ("hand.json", "hand.json.2"):
            with open(self.file(name)) as file:
                summaries.append(json.load(file))
            self.assertEqual((summaries[-1]["failure"], summaries[-1]["link"]["unanswered"]),
                             ("", 0))
        one, two = summaries
        self.assertNotEqual(one["participant"], two["participant"])
        removed = self.server.info()["removed_volume_mm3"]
        self.assertAlmostEqual(one["removed_mm3"] + two["removed_mm3"], removed,
                               delta=removed * 1e-4)


class Recordings(AgentTest):
    def export(self, recording):
        done = subprocess.run([AGENT, "export", recording], capture_output=True, text=True,
                              timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        return list(csv.DictReader(io.StringIO(done.stdout)))

    def run_study(self, recording, study):
        """Answers a study of one trial while it is recorded; returns the agent's summary."""
        agent = subprocess.Popen(
            self.words("--device", "sim", "--loop", "--record", recording, "--study", study,
                       "--trials", "1", "--interval", "1", "--seed", "4",
                       "--status-json", self.file("study.json")),
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        limit = threading.Timer(LIMIT_S, agent.kill)
        limit.start()
        self.addCleanup(limit.cancel)
        said = []
        for line in agent.stderr:
            said.append(line)
            if "a or b?" in line:
                agent.stdin.write("a\n")
                agent.stdin.flush()
        output = agent.communicate()[0]
        keep("agent", "".join(said))
        self.assertEqual(agent.returncode, 0, "".join(said))
        self.assertIn(f"1 trials in {study}", output)
        with open(self.file("study.json")) as file:
            return json.load(file)

    def test_a_study_is_recorded_with_every_tick_and_replays_to_the_same_block(self):
        file, study = self.file("carved.mcap"), self.file("study.csv")
        status = self.run_study(file, study)
        with open(study) as table:
            trial, = csv.DictReader(table)
        self.assertEqual({trial["mode_a"], trial["mode_b"]}, {"kerf", "paper"})
        self.assertEqual(trial["correct"], "1" if trial["mode_a"] == "kerf" else "0")
        record = status["record"]
        self.assertEqual((record["lost"], record["error"]), (0, ""))
        self.assertEqual(record["ticks"], status["servo"]["ticks"])
        self.assertGreater(status["copy"]["felt_ticks"], 100, "the replica answers")
        ticks = self.export(file)
        self.assertEqual(len(ticks), record["ticks"])
        self.assertEqual(set(row["mode"] for row in ticks), {"model", "paper", "silent"})
        most = max(sum(float(row[f"felt_f{i}_n"]) ** 2 for i in "xyz") ** 0.5 for row in ticks)
        self.assertAlmostEqual(most, status["force"]["max_n"], delta=1e-6)
        # Never overwritten. The error comes before anything is carved.
        self.assertIn("exists; choose another name",
                      self.run_agent("--device", "sim", "--record", file, code=1))
        # The replay reads poses between the ticks' times, so the volume is equal but the bytes are
        # not.
        self.server.create("again", SCENE)
        self.run_agent("--device", "replay:" + file, session="again")
        removed = [self.server.info(name)["removed_volume_mm3"] for name in ("block", "again")]
        self.assertGreater(removed[0], 1)
        self.assertAlmostEqual(removed[1], removed[0], delta=0.02 * removed[0])

    def test_a_killed_agent_leaves_its_recording_up_to_the_last_chunk(self):
        file = self.file("killed.mcap")
        agent = self.start("--device", "sim", "--loop", "--record", file)

        def has_a_chunk():
            self.assertIsNone(agent.poll(), "the agent has ended before it was killed")
            return os.path.exists(file) and os.path.getsize(file) >= 50_000

        eventually(has_a_chunk, "the recording does not grow", LIMIT_S)
        agent.send_signal(signal.SIGKILL)
        agent.wait()
        ticks = self.export(file)
        self.assertGreater(len(ticks), 500)
        self.assertEqual(set(row["has_pose"] for row in ticks), {"1"})


if __name__ == "__main__":
    run_tests()
