# SPDX-License-Identifier: Apache-2.0
"""Tests that requests that take long do not keep a real server from serving the others."""
import select
import socket
import unittest

from kept_logs import run_tests
from live_server import SCENE, LiveTest, until
from waiting import eventually
from wire_client import PATIENCE, WAIT_S, Agent

of_full_speed = unittest.skipIf(PATIENCE > 1, "a sanitizer needs memory of its own")

LONG = {**SCENE, "name": "long",
        "stock": {"shape": "box", "min_mm": [0, 0, -10], "max_mm": [100, 100, 0]},
        "accuracy": {**SCENE["accuracy"], "pitch_mm": 0.1}}


def raster(rows):
    """Rows of 100 mm with the ball, half a millimeter apart."""
    lines = ["G21 G90 T1 M6", "G0 X0 Y0 Z5", "G1 Z-2 F6000"]
    for row in range(rows):
        lines += [f"G1 X{100 if row % 2 == 0 else 0}", f"Y{0.5 * (row + 1)}"]
    return "\n".join(lines + ["M2", ""])


class Exports(LiveTest):
    def exports(self):
        return self.server.http.json("GET", "/v1/sessions/long/exports")[1]["exports"]

    def carve(self):
        self.server.create("long", LONG)
        status, program = self.server.http.json(
            "POST", "/v1/sessions/long/programs?pace=fast&name=raster.ngc", raster(200))
        self.assertEqual(status, 202, program)
        until(self, lambda: self.server.http.json("GET", program["url"])[1]["state"], "finished",
              4 * WAIT_S)

    def request(self):
        """Starts a download that takes seconds; returns the socket once it is being made."""
        client = socket.create_connection(("127.0.0.1", self.port))
        client.sendall(b"GET /v1/sessions/long/forces.csv HTTP/1.1\r\nHost: localhost\r\n\r\n")
        while not self.exports():
            answered = select.select([client], [], [], 0.002)[0]
            self.assertFalse(answered, "the file was made already")
        return client

    def test_a_download_ends_when_its_client_is_gone(self):
        self.carve()
        self.request().close()
        until(self, self.exports, [])
        # It was not completed: a second request has to make the file again.
        self.request().close()

    def test_a_server_that_shuts_down_cancels_downloads(self):
        self.carve()
        client = self.request()
        status, log = self.server.stop()
        self.assertEqual(status, 0, log)
        self.assertNotIn(b"200 OK", client.recv(4096))
        client.close()


class Uploads(LiveTest):
    def begin(self, address="127.0.0.1"):
        """Sends the header of an upload of 60 MB and the first part of it."""
        client = socket.create_connection(("127.0.0.1", self.port), source_address=(address, 0))
        client.sendall(b"POST /v1/files?name=a.stl HTTP/1.1\r\nHost: localhost\r\n"
                       b"Content-Length: 60000000\r\n\r\n" + b" " * 1000)
        return client

    def rejected(self, clients, count):
        """Waits until so many are rejected; returns the answers."""
        answers = {}
        while len(answers) < count:
            ready = select.select([c for c in clients if c not in answers], [], [], WAIT_S)[0]
            self.assertTrue(ready, f"only {len(answers)} of {count} uploads were rejected")
            answers.update((client, client.recv(4096)) for client in ready)
        self.assertEqual(len(answers), count)
        for answer in answers.values():
            self.assertIn(b" 503 ", answer)
            self.assertIn(b"Retry-After: ", answer)
        return list(answers.values())

    def upload_when_possible(self):
        def is_taken():
            path = "/v1/files?name=a.stl"
            return self.server.http.request("POST", path, b" " * 60_000_000)[0] != 503

        until(self, is_taken, True, 4 * WAIT_S)

    def test_unfinished_uploads_count_from_their_header_on(self):
        clients = [self.begin(f"127.0.0.{2 + n}") for n in range(40)]
        self.assertIn(b"all memory", self.rejected(clients, 36)[0])
        for client in clients:
            client.close()
        self.upload_when_possible()

    def memory_mb(self):
        """The memory of the server in use now."""
        with open(f"/proc/{self.server.process.pid}/status", encoding="ascii") as status:
            return next(int(line.split()[1]) for line in status if line.startswith("VmRSS")) / 1000

    def wait_for_memory(self, is_right):
        eventually(lambda: is_right(self.memory_mb()),
                   lambda: f"the server uses {self.memory_mb()} MB", 2 * WAIT_S)

    @of_full_speed
    def test_the_memory_of_uploads_that_break_off_is_given_back(self):
        before = self.memory_mb()
        clients = [self.begin(f"127.0.0.{2 + n}") for n in range(3)]
        for client in clients:
            client.sendall(b" " * 50_000_000)
        self.wait_for_memory(lambda now: now > before + 140)
        for client in clients:
            client.close()
        self.wait_for_memory(lambda now: now < before + 30)

    def test_unfinished_uploads_of_one_client_do_not_keep_others_out(self):
        clients = [self.begin("127.0.0.2") for _ in range(10)]
        self.assertIn(b"one client", self.rejected(clients, 8)[0])
        self.upload_when_possible()  # by another
        for client in clients:
            client.close()


class Programs(LiveTest):
    def memory_mb(self):
        with open(f"/proc/{self.server.process.pid}/status", encoding="ascii") as status:
            return next(int(line.split()[1]) for line in status if line.startswith("VmHWM")) / 1000

    @of_full_speed
    def test_a_short_program_with_many_motions_takes_little_memory(self):
        self.server.create("holes")
        before = self.memory_mb()
        for text in ("T1 M6\nF1 G91 G81 X.1 Z-1 R1 L200000\nM2",
                     "T1 M6\n#1=1\no1 while [#1 lt 200000]\n#1=[#1+1]\ng1 f9 x[sin[#1]]\no1 endwhile\nM2"):
            status, program = self.server.http.json(
                "POST", "/v1/sessions/holes/programs?pace=fast&name=p.ngc", text)
            self.assertEqual(status, 202, program)
            self.assertGreater(program["motions"], 150_000)
            self.server.http.json("DELETE", program["url"])
        # Each motion took 112 bytes or more when all were kept: 90 MB.
        self.assertLess(self.memory_mb() - before, 45)


class LongMotions(LiveTest):
    def test_an_agent_is_answered_while_a_motion_of_another_sweeps_the_whole_block(self):
        scene = {**SCENE, "name": "wide",
                 "stock": {"shape": "box", "min_mm": [0, 0, -10], "max_mm": [300, 300, 0]},
                 "accuracy": {**SCENE["accuracy"], "pitch_mm": 0.1},
                 "tools": [{"id": 1, "shape": "flat", "diameter_mm": 1000, "length_mm": 60},
                           {"id": 2, "shape": "ball", "diameter_mm": 2, "length_mm": 60}]}
        self.server.create("wide", scene)
        mill, ball = Agent(self.port, "wide", "Mill"), Agent(self.port, "wide", "Ball", tool=2)
        ball.move([(0, 0, 5)], tool=2)
        ball.result()
        while len(mill.receive_json("participants")["participants"]) < 2:
            pass  # from now on the mill receives nothing but its result
        mill.move([(150, 150, 1), (150, 150, -3)], step_us=100_000)
        answered = 0
        while not select.select([mill.socket], [], [], 0)[0]:
            ball.move([(1 + 0.1 * answered, 1, -4)], tool=2)
            ball.result()
            answered += 1
        self.assertGreater(mill.result()["removed"], 200_000)
        self.assertGreater(answered, 20)


if __name__ == "__main__":
    run_tests()
