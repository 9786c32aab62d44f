# SPDX-License-Identifier: Apache-2.0
"""Tests a real server with many viewers."""
import threading

from kept_logs import run_tests
from live_server import LiveTest
from wire_client import Agent, Closed, Viewer

VIEWERS = 200
TEXT_BYTES_MAX = 600_000  # one list of 200 names for each of 200 viewers has 3 MB


class Crowd(LiveTest):
    def change_tools(self, agent, stop):
        """Changes the tool as fast as the server reads, and reads the answers."""
        def read():
            try:
                while True:
                    agent.receive()
            except (Closed, OSError):
                pass
        reader = threading.Thread(target=read)
        reader.start()
        tool = 1
        while not stop.wait(0.001):
            tool = 3 - tool
            agent.send_json({"type": "tool", "tool": tool})
        agent.socket.shutdown(2)
        reader.join()

    def read_until_the_agent_has_left(self, viewer):
        """Follows the lists and changes of the participants; returns the last ones."""
        people = {p["participant"]: p for p in viewer.welcome["participants"]}
        count = viewer.welcome["viewers"]
        while count != VIEWERS or any(p["kind"] == "agent" for p in people.values()):
            kind = viewer.take()
            if kind == "participants":
                people = {p["participant"]: p for p in viewer.last["participants"]}
                count = viewer.last["viewers"]
            elif kind == "participants_changed":
                people.update({p["participant"]: p for p in viewer.last.get("changed", [])})
                for left in viewer.last.get("left", []):
                    people.pop(left, None)
                count = viewer.last["viewers"]
        return people

    def test_two_hundred_viewers_that_read_late_are_kept_and_cost_little_text(self):
        agent = Agent(self.port, "block")
        stop = threading.Event()
        changing = threading.Thread(target=self.change_tools, args=(agent, stop))
        changing.start()
        viewers = [Viewer(self.port, "block", f"viewer {i}", changes=i % 2 == 0)
                   for i in range(VIEWERS)]
        stop.set()
        changing.join()
        for viewer in viewers:  # one that the server has dropped raises Closed
            self.assertEqual(self.read_until_the_agent_has_left(viewer), {})
        self.assertLess(sum(viewer.text_bytes for viewer in viewers), TEXT_BYTES_MAX)
        self.assertEqual(len(self.server.info()["participants"]), VIEWERS)

    def test_every_viewer_of_a_crowd_gets_the_last_poses_and_tiles(self):
        viewers = [Viewer(self.port, "block", f"viewer {i}") for i in range(60)]
        agent = Agent(self.port, "block")
        agent.move([(0.1 * n, 1.0, -2.0) for n in range(12)])
        agent.move([(1.0, 2.0, 3.0)], buttons=0)  # no tile changes
        agent.result(13)
        motions = self.server.info()["motions"]
        for viewer in viewers:
            state = viewer.settled()
            while state["motions"] != motions:
                state = viewer.settled()
            self.assertEqual(viewer.tiles[(0, 0)], viewers[0].tiles[(0, 0)])
            while not viewer.tools or viewer.tools[0][2:5] != (1.0, 2.0, 3.0):
                viewer.take()


if __name__ == "__main__":
    run_tests()
