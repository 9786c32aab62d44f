# SPDX-License-Identifier: Apache-2.0
"""The past of a real server's session: points in time, and forces over it."""
import datetime
import os
import signal
import subprocess
import sys
import time
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from live_server import PROGRAM, LiveTest, Server  # noqa: E402
from live_undo_test import stroke  # noqa: E402
from wire_client import Agent  # noqa: E402


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
        time.sleep(0.05)
        between = time.time()
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

    def test_a_version_and_a_branch_from_it_outlast_a_restart(self):
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
        self.server.stop(signal.SIGKILL)
        for session in ("block", "other"):
            journal = os.path.join(self.folder.name, session + ".kerf")
            checked = subprocess.run([PROGRAM, "replay", journal], capture_output=True, text=True)
            self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)
        self.server = Server(self.folder.name, port=self.port)
        self.assertEqual([self.server.hash(), self.server.hash("other")], [now, carved])
        self.assertEqual(self.server.info("other")["parent"], branch["parent"])
        self.assertEqual([v["name"] for v in self.json("versions")[1]["versions"]], ["one stroke"])
        past = self.get("model.stl?at=one+stroke")
        self.assertIn(then, past[1]["etag"])
        self.assertEqual(self.json("model.stl?at=two")[1]["error"]["code"], "unknown_version")


if __name__ == "__main__":
    unittest.main()
