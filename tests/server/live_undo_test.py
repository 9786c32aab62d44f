# SPDX-License-Identifier: Apache-2.0
"""Strokes are undone and redone in a real server, while others carve, and across its death."""
import math
import os
import signal
import sys
import threading

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from kept_logs import run_tests  # noqa: E402
from live_server import LiveTest, Server, until  # noqa: E402
from wire_client import Agent, Viewer  # noqa: E402


def stroke(agent, y, depth=-3, count=40):
    """A line along x; the tool is lifted afterwards."""
    agent.move([(-15, y, 1)], buttons=0)
    agent.result()
    agent.move([(-15, y, 0.5)], buttons=0)
    for first in range(0, count, 8):
        agent.move([(-15 + 30 * n / count, y, depth * min(1, n / 4))
                    for n in range(first, first + 8)])
        agent.result()
    agent.move([(15, y, 1)], buttons=0)
    agent.result()


class Undo(LiveTest):
    def post(self, path):
        return self.server.http.json("POST", "/v1/sessions/block/" + path)

    def strokes(self):
        status, answer = self.server.http.json("GET", "/v1/sessions/block/strokes")
        self.assertEqual(status, 200, answer)
        return answer["strokes"]

    def test_strokes_are_undone_redone_and_kept(self):
        ada, bo, viewer = Agent(self.port, "block"), Agent(self.port, "block", "Bo"), \
            Viewer(self.port, "block")
        stroke(ada, 0)
        before = self.server.hash()
        stroke(bo, 6)
        after = self.server.hash()
        status, undone = self.post(f"undo?participant={bo.participant}")
        self.assertEqual(status, 200, undone)
        self.assertEqual(self.server.hash(), before)
        self.assertGreater(undone["returned_mm3"], 100)
        self.assertEqual([s["undone"] for s in self.strokes()], [False, True])
        until(self, lambda: viewer.settled()["state_hash"], before)
        # What was answered outlasts the death of the server.
        self.server.stop(signal.SIGKILL)
        self.server = Server(self.folder.name, port=self.port)
        until(self, lambda: self.server.http.json("GET", "/readyz")[0], 200)
        self.assertEqual(self.server.hash(), before)
        number = undone["strokes"][0]
        now, then, then_too = (self.server.http.request("GET", "/v1/sessions/block/model.stl" + at)
                               for at in ("", f"?at={undone['sequence']}",
                                          f"?at={undone['strokes'][0] - 1}"))
        self.assertEqual([now[0], then[0], then_too[0]], [200, 200, 200])
        self.assertEqual(now[2], then[2])
        self.assertEqual(now[2], then_too[2])
        self.assertEqual(
            self.server.http.json("GET", "/v1/sessions/block/model.stl?at=99999")[0], 404)
        status, redone = self.post(f"redo?strokes={number}")
        self.assertEqual(status, 200, redone)
        self.assertEqual(self.server.hash(), after)
        for path, code in ((f"redo?strokes={number}", 409), ("undo?strokes=999999", 409),
                           ("undo?strokes=x", 400), ("undo", 400),
                           ("undo?strokes=1&participant=1", 400)):
            self.assertEqual(self.post(path)[0], code, path)
        self.assertEqual(self.server.hash(), after)

    def test_others_carve_on_while_strokes_are_undone(self):
        ada, bo = Agent(self.port, "block"), Agent(self.port, "block", "Bo", stock=True)
        for n in range(6):
            stroke(ada, n - 3, count=160)
        stop = threading.Event()
        answered = []

        def carve():
            bo.move([(0, 12, 0.5)], buttons=0)
            n = 0
            while not stop.is_set() or n < 200:
                n += 1
                bo.move([(12 * math.sin(0.01 * n), 12 * math.cos(0.01 * n), -1)])
                answered.append(bo.result())

        thread = threading.Thread(target=carve)
        thread.start()
        try:
            for _ in range(6):
                status, answer = self.post(f"undo?participant={ada.participant}")
                self.assertEqual(status, 200, answer)
        finally:
            stop.set()
            thread.join()
        hands = {s["participant"]: s["undone"] for s in self.strokes()}
        self.assertEqual(hands, {ada.participant: True, bo.participant: False})
        now = self.server.hash()
        # A replay of the journal gives the same block.
        self.server.stop()
        self.server = Server(self.folder.name, port=self.port)
        until(self, lambda: self.server.http.json("GET", "/readyz")[0], 200)
        self.assertEqual(self.server.hash(), now)


if __name__ == "__main__":
    run_tests()
