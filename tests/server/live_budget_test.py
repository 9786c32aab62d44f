# SPDX-License-Identifier: Apache-2.0
"""Tests a real server with viewers that may be sent only so many bytes per second."""
import math
import threading
import time

from kept_logs import run_tests
from live_server import FolderTest, LiveTest, Server
from wire_client import Agent, Viewer

# What a tile has at most in a frame, and the burst and the step of the server's budget.
TILE_BYTES, BURST_S = 30_000, 0.55
LOOK = {"eye_mm": [0, 0, 500], "error_rad": 0}


class CountingViewer(Viewer):
    """Adds up the bytes of its mesh frames, and whether there were ever more than the budget."""

    def __init__(self, port, bytes_per_s, **more):
        self.bytes_per_s, self.mesh_bytes, self.most, self.coarse = bytes_per_s, 0, -math.inf, 0
        self.begin = time.monotonic()
        super().__init__(port, "block", **more)

    def apply(self, glb):
        super().apply(glb)
        self.mesh_bytes += len(glb)
        allowed = self.bytes_per_s * (time.monotonic() - self.begin + BURST_S) + TILE_BYTES
        self.most = max(self.most, self.mesh_bytes - allowed)
        self.coarse += sum(level == 1 for level in self.levels.values())


def cut_until(stop, port):
    """Cuts at some 1 kHz across the whole block, deeper and deeper."""
    agent = Agent(port, "block")
    for step in range(100_000):
        if stop.is_set():
            break
        angle = step * 0.02
        radius = 14 * abs(math.sin(step * 0.0013))
        agent.move([(radius * math.cos(angle), radius * math.sin(angle), -1 - step * 0.002)])
        agent.result()
    agent.close()


class Budget(LiveTest):
    def watch(self, viewers, until):
        """Lets viewers read while an agent cuts, and until they have everything."""
        stop = threading.Event()
        agent = threading.Thread(target=cut_until, args=(stop, self.server.port))
        agent.start()
        try:
            while not until():
                for viewer in viewers:
                    viewer.take()
        finally:
            stop.set()
            agent.join()
        for viewer in viewers:
            while viewer.settled()["state_hash"] != self.server.hash():
                pass  # a state of before, which this viewer had not read

    def test_a_viewer_is_never_sent_more_and_has_everything_exactly_at_the_end(self):
        free, bound = CountingViewer(self.server.port, math.inf), \
            CountingViewer(self.server.port, 25_000, budget=25_000)
        self.assertNotIn("budget", free.welcome)
        self.assertEqual(bound.welcome["budget"], 25_000)
        self.watch([bound, free], lambda: free.mesh_bytes > 400_000 and bound.coarse > 0)
        self.assertLessEqual(bound.most, 0)
        self.assertEqual(free.coarse, 0)
        self.assertEqual(set(bound.levels.values()), {0})
        self.assertEqual(bound.tiles.keys(), free.tiles.keys())

    def test_a_budget_is_taken_back_in_a_look(self):
        viewer = CountingViewer(self.server.port, 25_000, budget=25_000)
        viewer.settled()
        viewer.send_json({"type": "look", **LOOK, "budget": 24_999})
        self.assertEqual(viewer.receive_json("error")["code"], "bad_message")
        viewer.send_json({"type": "look", **LOOK, "budget": 0})
        self.watch([viewer], lambda: viewer.most > 0)

    def test_the_past_comes_within_the_budget_too(self):
        viewer = CountingViewer(self.server.port, 25_000, budget=25_000)
        self.watch([viewer], lambda: viewer.coarse > 0)
        records = self.server.info()["motions"]
        viewer.send_json({"type": "seek", "at": records // 2})
        while "at" not in viewer.settled():
            pass
        self.assertEqual(set(viewer.levels.values()), {0})
        viewer.send_json({"type": "seek", "at": "live"})
        while "at" in viewer.settled():
            pass
        self.assertEqual(viewer.last["state_hash"], self.server.hash())
        self.assertLessEqual(viewer.most, 0)


class Ceiling(FolderTest):
    def first_server(self):
        return Server(self.folder.name, "--viewer-budget", "50")

    def test_the_server_bounds_what_each_viewer_gets(self):
        for stated, got in (({}, 50_000), ({"budget": 0}, 50_000), ({"budget": 900_000}, 50_000),
                            ({"budget": 30_000}, 30_000)):
            with self.subTest(stated):
                viewer = CountingViewer(self.server.port, got, **stated)
                self.assertEqual(viewer.welcome["budget"], got)
                viewer.settled()
                self.assertLessEqual(viewer.most, 0)
                viewer.close()


if __name__ == "__main__":
    run_tests()
