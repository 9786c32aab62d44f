# SPDX-License-Identifier: Apache-2.0
"""The past of a real server's session: points in time, and forces over it."""
import datetime
import os
import signal
import subprocess
import sys
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from kept_logs import run_tests  # noqa: E402
from live_server import PROGRAM, LiveTest, Server, until  # noqa: E402
from live_undo_test import stroke  # noqa: E402
from waiting import eventually  # noqa: E402
from wire_client import WAIT_S, Agent, Viewer  # noqa: E402


def utc(seconds):
    moment = datetime.datetime.fromtimestamp(seconds, datetime.timezone.utc)
    return moment.strftime("%Y-%m-%dT%H:%M:%S.%fZ")


class PointsInTime(LiveTest):
    def get(self, path):
        return self.server.http.request("GET", "/v1/sessions/block/" + path)

    def json(self, path):
        return self.server.http.json("GET", "/v1/sessions/block/" + path)

    def test_the_block_and_the_forces_at_a_time(self):
        before = time.time()
        ada = Agent(self.port, "block")
        stroke(ada, 0)
        between = time.time() + 0.01  # what was answered has been recorded
        eventually(lambda: time.time() > between, "the clock stands still")
        then = self.get("model.stl")
        stroke(ada, 8)
        now = self.get("model.stl")
        self.assertNotEqual(then[2], now[2])
        for at, expected in ((between, then), (time.time(), now)):
            past = self.get("model.stl?at=" + utc(at))
            self.assertEqual((past[0], past[2]), (200, expected[2]), at)
        self.assertNotIn(self.get("model.stl?at=" + utc(before - 60))[2], (then[2], now[2]))
        for at, status, code in ((utc(time.time() + 3600), 404, "no_record"),
                                 ("99999", 404, "no_record"), ("yesterday", 404, "unknown_version"),
                                 ("a%2Fb", 400, "bad_at"),
                                 ("2026-02-30T00:00:00Z", 404, "unknown_version")):
            answer = self.json("model.stl?at=" + at)
            self.assertEqual((answer[0], answer[1]["error"]["code"]), (status, code), at)
        motions = self.get("forces.csv")[2].decode().splitlines()[1:]
        status, plot = self.json("forces?points=10")
        self.assertEqual(status, 200)
        self.assertEqual(sum(plot["motions"]), len(motions))
        self.assertLessEqual(len(plot["first"]), 10)
        self.assertGreater(max(plot["force_n"]["max"]), 0.1)
        for query, code in (("points=0", "bad_points"), ("points=5001", "bad_points"),
                            ("points=x", "bad_points"), ("from=5&to=4", "bad_span"),
                            ("from=x", "bad_span"), ("participant=x", "bad_participant")):
            answer = self.json("forces?" + query)
            self.assertEqual((answer[0], answer[1]["error"]["code"]), (400, code), query)

    def reached(self, viewer, record, **fields):
        """Waits until the viewer has all tiles of a record; returns the state message."""
        while True:
            state = viewer.settled()
            place = state.get("at")
            if place and place["record"] == record and all(
                    place[name] == value for name, value in fields.items()):
                return state

    def test_one_viewer_looks_at_the_past_while_others_carve_and_watch(self):
        ada, past, live = Agent(self.port, "block"), Viewer(self.port, "block"), \
            Viewer(self.port, "block", "Bo")
        past.keeps_meshes = True
        hashes = {}
        for y in (-8, 0, 8):
            stroke(ada, y, count=80)
            hashes[self.server.info()["state_sequence"]] = self.server.hash()
        until(self, lambda: past.settled()["state_hash"], self.server.hash())
        first, second, last = sorted(hashes)
        untouched = dict(past.tiles)
        for record in (second, first, last, first):
            past.send_json({"type": "seek", "at": record})
            state = self.reached(past, record, rate=0)
            self.assertEqual(state["state_hash"], hashes[record])
        self.assertEqual(past.welcomes, 2)
        self.assertEqual(set(past.tiles), set(untouched))
        # It plays to the end, while Ada carves on and the other viewer sees the present.
        stroke(ada, 4)
        now, end = self.server.hash(), self.server.info()["state_sequence"]
        until(self, lambda: live.settled()["state_hash"], now)
        self.assertNotIn("at", live.last)
        past.send_json({"type": "seek", "rate": 64})
        self.assertEqual(self.reached(past, end, rate=64)["state_hash"], now)
        self.assertEqual([tool[0] for tool in past.tools], [ada.participant])
        past.send_json({"type": "seek", "at": end - 5, "rate": 0.25})
        self.assertEqual(self.reached(past, end, rate=0.25)["state_hash"], now)
        # And is back in the present, with the tiles that a new viewer gets.
        past.send_json({"type": "seek", "at": first})
        self.reached(past, first)
        past.send_json({"type": "seek", "at": "live"})
        while "at" in past.settled():
            pass
        self.assertEqual(past.last["state_hash"], now)
        fresh = Viewer(self.port, "block")
        fresh.keeps_meshes = True
        fresh.settled()
        self.assertEqual(past.meshes, fresh.meshes)
        self.assertEqual(live.welcomes, 1)

    def await_message(self, viewer, kind):
        end = time.monotonic() + WAIT_S
        while viewer.take() != kind:
            self.assertLess(time.monotonic(), end, kind)
        return viewer.last

    def test_programs_are_sent_again_after_each_seek(self):
        status, program = self.server.http.json(
            "POST", "/v1/sessions/block/programs?pace=fast&name=p.ngc",
            "G21 G90 G94\nT2 M6\nG0 X0 Y0 Z5\nG1 Z-2 F3000\nM2\n")
        self.assertEqual(status, 202, program)
        until(self, lambda: self.server.http.json("GET", program["url"])[1]["state"], "finished")
        viewer = Viewer(self.port, "block")
        self.assertEqual(len(self.await_message(viewer, "programs")["programs"]), 1)
        viewer.settled()
        for at in (1, "live"):
            viewer.send_json({"type": "seek", "at": at})
            self.await_message(viewer, "welcome")
            self.assertEqual(len(self.await_message(viewer, "programs")["programs"]), 1, at)

    def test_seeks_that_cannot_be_met_are_rejected(self):
        viewers = [Viewer(self.port, "block") for _ in range(5)]
        first = viewers[0]
        for seek, code in (({"at": 99}, "bad_message"), ({"rate": 1}, "bad_message"),
                           ({"at": "then"}, "bad_message"), ({"at": 1, "rate": 99}, "bad_message")):
            first.send_json({"type": "seek", **seek})
            self.assertEqual(first.receive_json("error")["code"], code, seek)
        self.assertEqual(first.welcomes, 1)
        for viewer in viewers[:4]:
            viewer.send_json({"type": "seek", "at": 1})
            self.reached(viewer, 1)
        viewers[4].send_json({"type": "seek", "at": 1})
        self.assertEqual(viewers[4].receive_json("error")["code"], "busy")
        first.send_json({"type": "seek", "at": 99})
        self.assertEqual(first.receive_json("error")["code"], "bad_message")
        first.send_json({"type": "seek", "at": "live"})
        while "at" in first.settled():
            pass
        viewers[4].send_json({"type": "seek", "at": 1})
        self.reached(viewers[4], 1)

    def replay(self, session, *more):
        journal = os.path.join(self.folder.name, session + ".kerf")
        return subprocess.run([PROGRAM, "replay", journal, *more], capture_output=True, text=True)

    def test_a_version_and_a_branch_from_it_outlast_a_restart(self):
        untouched = self.server.hash()
        ada = Agent(self.port, "block")
        stroke(ada, 0)
        status, version = self.server.http.json("POST", "/v1/sessions/block/versions?name=one+stroke")
        self.assertEqual(status, 201, version)
        then = self.server.hash()
        stroke(ada, 8)
        undone = self.server.http.json("POST", "/v1/sessions/block/undo?participant="
                                       + str(ada.participant))
        self.assertEqual(undone[0], 200, undone)
        now = self.server.hash()
        status, branch = self.server.http.json("POST",
                                               "/v1/sessions?id=other&from=block@one+stroke")
        self.assertEqual(status, 201, branch)
        self.assertEqual(branch["parent"]["session"], "block")
        self.assertEqual(branch["parent"]["record"], version["record"])
        bo = Agent(self.port, "other", "Bo")
        self.assertEqual(self.server.hash("other"), then)
        stroke(bo, -8)
        carved = self.server.hash("other")
        self.assertEqual(self.server.hash(), now)
        self.assertEqual(self.json("strokes")[1]["strokes"][0],
                         self.server.http.json("GET", "/v1/sessions/other/strokes")[1]["strokes"][0])
        strokes = [[s["id"] for s in self.server.http.json(
            "GET", f"/v1/sessions/{name}/strokes")[1]["strokes"]] for name in ("block", "other")]
        self.server.stop(signal.SIGKILL)
        for name, without, expected in (("block", strokes[0][:1], untouched),
                                        ("other", strokes[1][1:], then),
                                        ("other", strokes[1], untouched)):
            done = self.replay(name, "--without-strokes", ",".join(map(str, without)))
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertTrue(done.stdout.endswith(f"hash {expected}\n"), done.stdout)
        self.assertEqual(self.replay("block", "--without-strokes", "99999").returncode, 1)
        for session in ("block", "other"):
            checked = self.replay(session)
            self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)
        self.server = Server(self.folder.name, port=self.port)
        self.assertEqual([self.server.hash(), self.server.hash("other")], [now, carved])
        self.assertEqual(self.server.info("other")["parent"], branch["parent"])
        self.assertEqual([v["name"] for v in self.json("versions")[1]["versions"]], ["one stroke"])
        past = self.get("model.stl?at=one+stroke")
        self.assertIn(then, past[1]["etag"])
        self.assertEqual(self.json("model.stl?at=two")[1]["error"]["code"], "unknown_version")


if __name__ == "__main__":
    run_tests()
