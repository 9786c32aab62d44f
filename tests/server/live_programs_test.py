# SPDX-License-Identifier: Apache-2.0
"""Tests the control of programs in a real server: pause, step, resume, speed, queue, source."""
import http.client
import json
import math
import os
import pathlib
import select
import subprocess

from kept_logs import run_tests
from live_server import LiveTest
from waiting import eventually
from wire_client import Viewer


def spiral(blocks):
    """A program with one cutting block a line."""
    lines = ["G21 G90 G17 G94", "T2 M6", "G0 X0 Y0 Z5", "G1 Z-2 F3000"]
    for n in range(blocks):
        angle, radius = n * 0.1, 2 + 12 * n / blocks
        lines.append(f"G1 X{radius * math.cos(angle):.3f} Y{radius * math.sin(angle):.3f} F6000")
    return "\n".join(lines + ["M2", ""])


class Programs(LiveTest):
    def ask(self, method, path, body=None):
        return self.server.http.json(method, path, body)

    def upload(self, text, query, session="block"):
        status, body = self.ask("POST", f"/v1/sessions/{session}/programs?{query}", text)
        self.assertEqual(status, 202, body)
        return body

    def change(self, program, query):
        status, body = self.ask("PATCH", f"{program['url']}?{query}")
        self.assertEqual(status, 200, body)
        return body

    def until(self, program, *states):
        def status():
            found = self.ask("GET", program["url"])[1]
            return found if found["state"] in states else None

        return eventually(status, f"the program is not {' or '.join(states)}", 60)

    def refused(self, method, path):
        status, body = self.ask(method, path)
        return status, body["error"]["code"]

    def test_a_program_that_is_paused_stepped_and_resumed_cuts_the_same(self):
        text = spiral(300)
        self.server.create("straight")
        self.until(self.upload(text, "pace=fast&name=s.ngc", "straight"), "finished")
        program = self.upload(text, "pace=feed&speed=0.1&name=s.ngc")
        paused = self.change(program, "do=pause")
        self.assertEqual(paused["state"], "paused")
        self.assertEqual(self.server.http.request("GET", program["url"] + "/source")[2],
                         text.encode())
        self.change(program, "pace=fast")
        lines = []
        for _ in range(5):
            self.change(program, "do=step")
            lines.append(self.until(program, "paused")["line"])
        self.assertEqual(lines, sorted(set(lines)))
        before = self.ask("GET", program["url"])[1]
        # Another program, which is not paused, begins and ends meanwhile.
        self.server.create("meanwhile")
        self.until(self.upload(text, "pace=fast&name=s.ngc", "meanwhile"), "finished")
        self.assertEqual(self.ask("GET", program["url"])[1], before)
        self.assertAlmostEqual(before["elapsed_s"] + before["remaining_s"],
                               before["programmed_s"], places=6)
        self.change(program, "do=resume&speed=1")
        eventually(lambda: self.ask("GET", program["url"])[1]["line"] > before["line"],
                   "the program does not go on")
        self.change(program, "do=pause")
        self.change(program, "do=resume&pace=fast")
        self.until(program, "finished")
        self.assertEqual(self.refused("PATCH", program["url"] + "?do=pause"),
                         (409, "not_running"))
        self.assertEqual(self.server.hash(), self.server.hash("straight"))

    def test_every_speed_cuts_the_same_and_a_sampled_path_does_not(self):
        text = spiral(60)
        self.until(self.upload(text, "name=s.ngc"), "finished")
        for name, query in (("one", "pace=feed&speed=20"), ("two", "pace=feed&speed=0.1")):
            self.server.create(name)
            program = self.upload(text, query + "&name=s.ngc", name)
            for speed in ("1", "7.3", "0.5", "20"):
                self.change(program, f"speed={speed}")
            self.until(program, "finished")
            self.assertEqual(self.server.hash(), self.server.hash(name), query)
        self.server.create("sampled")
        self.until(self.upload(text, "sample_hz=20&name=s.ngc", "sampled"), "finished")
        self.assertNotEqual(self.server.hash(), self.server.hash("sampled"))

    def test_a_program_has_a_stroke_for_each_pass(self):
        text = "G21 G90\nT2 M6\nG0 Z20\n" + "".join(
            f"G0 X-10 Y{y}\nG0 Z10\nG1 Z-2 F6000\nG1 X10\nG0 Z20\n" for y in (-6, 0, 6)) + "M2\n"
        for name, query in (("fast", "pace=fast"), ("feed", "speed=20")):
            self.server.create(name)
            self.until(self.upload(text, query + "&name=s.ngc", name), "finished")
            strokes = self.ask("GET", f"/v1/sessions/{name}/strokes")[1]["strokes"]
            self.assertEqual(len(strokes), 3, strokes)
        self.assertEqual(self.server.hash("fast"), self.server.hash("feed"))
        before = self.server.info("fast")["removed_volume_mm3"]
        status, body = self.ask("POST", f"/v1/sessions/fast/undo?strokes={strokes[-1]['id']}")
        self.assertEqual(status, 200, body)
        self.assertAlmostEqual(body["returned_mm3"], before / 3, delta=before / 20)

    def test_a_scene_is_derived_as_on_the_command_line(self):
        apt = "PARTNO A\nUNITS/MM\nCUTTER/8\nLOADTL/1\nFEDRAT/500\nGOTO/0,0,-2\nGOTO/30,0,-2\nFINI\n"
        for name, text in (("spiral.ngc", spiral(20)), ("part.apt", apt),
                           ("ball.nc", "(T3 - 4MM BALL ENDMILL)\nG20 G90\nT3 M6\nG1 X1 Z-.1 F20\nM30\n")):
            status, body = self.ask("POST", f"/v1/programs?name={name}", text)
            self.assertEqual(status, 200, body)
            path = pathlib.Path(self.folder.name, name)
            path.write_text(text)
            printed = subprocess.run([os.environ["KERF_CARVE"], "--derive", "--program", str(path)],
                                     capture_output=True, text=True, check=True).stdout
            self.assertEqual(json.loads(printed), body, name)
            self.server.create(name.replace(".", "-"), body["scene"])
        status, body = self.ask("POST", "/v1/programs?name=air.ngc", "G21\nG0 X5\nM30\n")
        self.assertEqual((status, body["error"]["code"]), (400, "bad_program"))

    def test_programs_of_a_queue_run_one_after_the_other(self):
        # So slow that it is not at its end before it is paused.
        first = self.upload(spiral(20), "pace=feed&speed=0.1&name=first.ngc")
        self.change(first, "do=pause")
        second = self.upload(spiral(20), "pace=fast&queue=1&name=second.ngc")
        third = self.upload(spiral(20), f"pace=fast&after={second['id']}&name=third.ngc")
        self.assertEqual([second["state"], third["state"]], ["queued", "queued"])
        self.assertEqual(third["after"], second["id"])
        self.assertEqual(self.refused("PATCH", second["url"] + "?do=resume"),
                         (409, "not_running"))
        self.change(first, "do=resume&speed=20")
        self.until(third, "finished")
        self.assertEqual(self.ask("GET", second["url"])[1]["state"], "finished")
        fourth = self.upload(spiral(200), "pace=feed&speed=0.1&name=fourth.ngc")
        fifth = self.upload(spiral(20), "queue=1&name=fifth.ngc")
        self.ask("DELETE", fourth["url"])
        self.assertIn("was cancelled", self.until(fifth, "cancelled")["error"])

    def test_viewers_hear_of_programs_and_their_paths_can_be_drawn(self):
        viewer = Viewer(self.port, "block")
        text = spiral(200)
        program = self.upload(text, "pace=feed&speed=0.1&name=s.ngc")
        self.change(program, "do=pause")
        sent = viewer.receive_json("programs")["programs"]
        while sent[0]["state"] != "paused":
            sent = viewer.receive_json("programs")["programs"]
        self.assertEqual((sent[0]["id"], sent[0]["name"]), (program["id"], "s.ngc"))
        self.assertEqual(Viewer(self.port, "block").receive_json("programs")["programs"], sent)
        whole = self.ask("GET", program["url"] + "/path?points=20000")[1]
        self.assertEqual(whole["error_mm"], 0)
        self.assertEqual((whole["kind"][:2], whole["line"][-1]), ("sf", text.count("\n") - 1))
        few = self.ask("GET", program["url"] + "/path?points=30")[1]
        self.assertLessEqual(few["points"], 30)
        for column in ("x_mm", "y_mm", "z_mm", "line", "tool", "kind"):
            self.assertEqual(len(few[column]), few["points"], column)
        for points in ("1", "20001", "x"):
            self.assertEqual(self.refused("GET", program["url"] + f"/path?points={points}"),
                             (400, "bad_value"))
        self.change(program, "do=resume&pace=fast")
        self.until(program, "finished")
        self.assertEqual(self.ask("GET", program["url"] + "/path?points=20000")[1], whole)

    def test_orders_that_make_no_sense_are_rejected(self):
        program = self.upload(spiral(200), "pace=feed&speed=0.1&name=s.ngc")
        url, upload = program["url"], "/v1/sessions/block/programs?"
        for query, code in (("", "bad_value"), ("do=jump", "bad_order"), ("speed=0.05", "bad_speed"),
                            ("speed=21", "bad_speed"), ("speed=nan", "bad_speed"),
                            ("pace=slow", "bad_pace")):
            self.assertEqual(self.refused("PATCH", f"{url}?{query}"), (400, code), query)
        for query, code in (("after=9", "bad_message"), ("after=x", "bad_value"),
                            ("queue=2", "bad_value"), ("speed=x", "bad_speed"),
                            ("force_limit_n=0", "bad_value")):
            self.assertEqual(self.refused("POST", upload + query), (400, code), query)
        self.assertEqual(self.refused("PATCH", "/v1/sessions/block/programs/9?do=pause"),
                         (404, "unknown_program"))
        self.assertEqual(self.refused("GET", "/v1/sessions/block/programs/9/source"),
                         (404, "unknown_program"))

    def test_a_pin_does_not_wait_for_programs_without_an_end(self):
        # Each takes seconds of CPU time until its limit of lines.
        text = "O1\nT1 M6\n#1=0\nWHILE[1EQ1]DO1\n#1=#1+1\nEND1\nM30\n"
        peers = []
        for _ in range(6):
            peer = http.client.HTTPConnection("127.0.0.1", self.port)
            self.addCleanup(peer.close)
            peer.request("POST", "/v1/sessions/block/programs?dialect=fanuc", text)
            peers.append(peer)
        status, pin = self.ask("POST", "/v1/sessions/block/pins?text=a&at_mm=0,0,0&normal=0,0,1")
        self.assertEqual(status, 201, pin)
        self.assertEqual(select.select([peer.sock for peer in peers], [], [], 0)[0], [])


if __name__ == "__main__":
    run_tests()
