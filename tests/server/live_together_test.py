# SPDX-License-Identifier: Apache-2.0
"""Tests pins and shown cameras in a real server, as several viewers see them."""

from kept_logs import run_tests
from live_server import LiveTest, Server
from wire_client import Viewer

PIN = "/v1/sessions/block/pins"
PLACE = "&at_mm=1,2,0&normal=0,0,1"


class Together(LiveTest):
    def ask(self, method, path):
        return self.server.http.json(method, path)

    def set_pin(self, text):
        status, pin = self.ask("POST", f"{PIN}?text={text}&author=Ada{PLACE}")
        self.assertEqual(status, 201, pin)
        return pin

    def texts(self, viewer, *expected):
        """Waits for the message with these pins."""
        while True:
            sent = [pin["text"] for pin in viewer.receive_json("pins")["pins"]]
            if sent == list(expected):
                return

    def cameras(self, viewer, count):
        """Waits for so many cameras."""
        while True:
            sent = viewer.receive_json("cameras")["cameras"]
            if len(sent) == count:
                return sent

    def test_viewers_see_pins_at_once_and_after_a_restart(self):
        first = Viewer(self.port, "block")
        pin = self.set_pin("deep")
        self.assertEqual((pin["author"], pin["at_mm"], pin["normal"]), ("Ada", [1, 2, 0], [0, 0, 1]))
        self.texts(first, "deep")
        second = Viewer(self.port, "block")
        self.texts(second, "deep")
        self.set_pin("two")
        self.texts(second, "deep", "two")
        second.send_json({"type": "seek", "at": 0})
        self.texts(second, "deep", "two")  # another block begins: the lists come again
        self.assertEqual(self.ask("DELETE", f"{PIN}/{pin['pin']}")[0], 200)
        self.texts(first, "two")
        self.server.stop()
        self.server = Server(self.folder.name)
        self.port = self.server.port
        self.assertEqual([p["text"] for p in self.ask("GET", PIN)[1]["pins"]], ["two"])
        self.texts(Viewer(self.port, "block"), "two")
        self.assertEqual(self.ask("DELETE", f"{PIN}/{pin['pin']}")[1]["error"]["code"],
                         "unknown_pin")

    def test_a_camera_is_shown_until_its_viewer_hides_it_or_leaves(self):
        watchers = [Viewer(self.port, "block", name=f"Viewer {n}") for n in range(9)]
        pose = {"type": "camera", "eye_mm": [1, 2, 3], "target_mm": [0, 0, 0]}
        watchers[0].send_json(pose)
        [shown] = self.cameras(watchers[8], 1)
        self.assertEqual(shown, {"participant": watchers[0].participant, "name": "Viewer 0",
                                 "color": watchers[0].welcome["color"], "eye_mm": [1, 2, 3],
                                 "target_mm": [0, 0, 0], "parallel": False})
        for n in range(20):
            watchers[0].send_json({**pose, "eye_mm": [n, 2, 3], "parallel": True})
        while self.cameras(watchers[8], 1)[0]["eye_mm"][0] != 19:
            pass
        late = Viewer(self.port, "block")
        self.assertEqual(self.cameras(late, 1)[0]["parallel"], True)
        for viewer in watchers[1:8]:
            viewer.send_json(pose)
        self.cameras(late, 8)
        watchers[8].send_json(pose)
        self.assertEqual(watchers[8].receive_json("error")["code"], "busy")
        watchers[0].send_json({"type": "camera"})
        self.cameras(late, 7)
        watchers[1].close()
        self.cameras(late, 6)


if __name__ == "__main__":
    run_tests()
