# SPDX-License-Identifier: Apache-2.0
"""Invalid input of a peer is answered with a typed error and does not affect the session."""
import json
import socket
import struct
import time

from kept_logs import run_tests
from live_server import SCENE, LiveTest, Server
from wire_client import (ACK, MOTION, Agent, Closed, Rejected, Viewer, WebSocket, header,
                         motion_frame, sample)

NAN = float("nan")


class BadFrames(LiveTest):
    def setUp(self):
        super().setUp()
        self.bad = Agent(self.port, "block", "Mallory")
        self.good = Agent(self.port, "block", "Ada")

    def expect(self, code, peer=None):
        error = (peer or self.bad).receive_json("error")
        self.assertEqual(error["code"], code, error)
        self.assertTrue(error["reason"])
        self.assert_both_go_on(peer)

    def assert_both_go_on(self, peer=None):
        before = self.server.info()["motions"]
        for agent in {self.good, peer or self.bad}:
            agent.move([(0, 0, -1)])
            agent.move([(1, 0, -1), (2, 0, -1.5)])
            agent.result()
        self.assertGreaterEqual(self.server.info()["motions"], before + 4)

    def test_garbage_is_a_bad_frame(self):
        self.bad.send_binary(b"garbage")
        self.expect("bad_frame")

    def test_wrong_magic_is_a_bad_frame(self):
        self.bad.send_binary(header(MOTION, 0, magic=0x12345678))
        self.expect("bad_frame")

    def test_wrong_payload_length_is_a_bad_frame(self):
        self.bad.send_binary(header(MOTION, 72) + b"\0" * 8)
        self.expect("bad_frame")

    def test_oversize_frame_is_too_large(self):
        self.bad.send_binary(b"\0" * 5000)
        self.expect("too_large")

    def test_huge_frame_closes_only_its_connection_with_1009(self):
        self.bad.send_frame(2, b"\0" * 70000)
        with self.assertRaises(Closed) as closed:
            self.bad.receive_json("error", 10)
        self.assertEqual(closed.exception.code, 1009)
        self.good.move([(0, 0, -1)])
        self.good.move([(1, 0, -1)])
        self.assertGreater(self.good.result()["removed"], 0)

    def test_unmasked_frame_closes_with_1002(self):
        self.bad.send_frame(2, b"abc", masked=False)
        with self.assertRaises(Closed) as closed:
            self.bad.receive_json("error", 10)
        self.assertEqual(closed.exception.code, 1002)

    def test_reserved_bits_close_with_1002(self):
        self.bad.send_frame(2, b"abc", first=0xF0)
        with self.assertRaises(Closed) as closed:
            self.bad.receive_json("error", 10)
        self.assertEqual(closed.exception.code, 1002)

    def test_count_of_zero_and_of_seventeen_are_bad(self):
        self.bad.send_binary(header(MOTION, 8) + struct.pack("<II", 0, 0))
        self.expect("bad_frame")
        many = [sample(100 + i, 10**7 + i, (0, 0, 5)) for i in range(17)]
        self.bad.send_binary(motion_frame(many))
        self.expect("bad_frame")

    def test_nan_tip_is_a_bad_pose(self):
        self.bad.move([(NAN, 0, 0)])
        self.expect("bad_pose")

    def test_infinite_axis_is_a_bad_pose(self):
        self.bad.move([(0, 0, 0)], axis=(0, 0, float("inf")))
        self.expect("bad_pose")

    def test_axis_of_length_two_is_a_bad_pose(self):
        self.bad.move([(0, 0, 0)], axis=(0, 0, 2))
        self.expect("bad_pose")

    def test_tip_a_million_metres_away_is_a_bad_pose(self):
        self.bad.move([(1e9, 0, 0)])
        self.expect("bad_pose")

    def test_unknown_tool_is_named(self):
        self.bad.move([(0, 0, 0)], tool=99)
        self.expect("unknown_tool")

    def test_jump_while_cutting_is_too_fast(self):
        self.bad.move([(0, 0, 5)])
        self.bad.move([(0, 0, -15)])
        self.expect("too_fast")

    def test_reversed_axis_is_rejected(self):
        self.bad.move([(0, 0, 5)], axis=(0, 0, 1))
        self.bad.move([(0, 0, 5)], axis=(0, 0, -1))
        self.expect("turn_too_large")

    def test_constant_sample_time_is_a_bad_message(self):
        self.bad.move([(0, 0, 5)])
        self.bad.move([(1, 0, 5)], step_us=0)
        self.expect("bad_message")

    def test_malformed_json_is_bad_json(self):
        for text in ("{", "", "[1,2]", '"hello"', '{"type":"tool"', "\xff\xfe"):
            self.bad.send_text(text)
            self.expect("bad_json")

    def test_wrong_fields_are_bad_messages(self):
        for message in ({"type": "dance"}, {"type": "tool"}, {"type": "tool", "tool": "one"},
                        {"type": "tool", "tool": -1}, {"type": 7}, {},
                        {"type": "hello", "name": "again"},
                        {"type": "look", "eye_mm": [0, 0, 9], "error_rad": 0}):
            self.bad.send_json(message)
            self.expect("bad_message")
        self.bad.send_json({"type": "tool", "tool": 77})
        self.expect("unknown_tool")

    def test_frames_of_other_roles_are_bad_messages(self):
        self.bad.send_binary(header(ACK, 0))
        self.expect("bad_message")

    def test_unknown_binary_type_is_skipped(self):
        self.bad.send_binary(header(99, 4) + b"\0" * 4)
        self.assert_both_go_on()

    def test_repeated_samples_are_skipped(self):
        self.bad.move([(0, 0, -1)])
        frame = motion_frame([sample(2, 2_000_000, (5, 0, -1))])
        self.bad.send_binary(frame)
        first = self.bad.result(2)
        self.bad.send_binary(frame)
        again = self.bad.result(2)
        self.assertGreater(first["removed"], 0)
        self.assertEqual(again["removed"], 0)
        self.assertEqual(again["motions"], first["motions"])

    def test_flood_of_samples_is_too_fast(self):
        tips = [(0, 0, 5)] * 16
        for _ in range(120):
            self.bad.move(tips, step_us=100, buttons=0)
        self.expect("too_fast", self.good_after_flood())

    def good_after_flood(self):
        error = self.bad.receive_json("error")
        self.assertEqual(error["code"], "too_fast")
        flooder = self.bad
        time.sleep(1.2)  # the rate limit recovers
        return flooder

    def test_vanished_peer_is_removed(self):
        self.bad.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        self.bad.close()
        people = self.good.receive_json("participants")
        while len(people["participants"]) != 1:
            people = self.good.receive_json("participants")
        self.assertEqual(people["participants"][0]["name"], "Ada")


class BadViewers(LiveTest):
    def test_viewer_that_sends_motions_gets_an_error(self):
        viewer = Viewer(self.port, "block")
        viewer.send_binary(motion_frame([sample(1, 1, (0, 0, 0))]))
        self.assertEqual(viewer.receive_json("error")["code"], "bad_message")
        viewer.send_json({"type": "tool", "tool": 1})
        self.assertEqual(viewer.receive_json("error")["code"], "bad_message")
        for look in ({"eye_mm": [1, 2, 3]}, {"error_rad": 0.001},
                     {"eye_mm": [1, 2], "error_rad": 0.001},
                     {"eye_mm": [1, 2, "3"], "error_rad": 0.001},
                     {"eye_mm": [1, 2, 1e7], "error_rad": 0.001},
                     {"eye_mm": [1, 2, 3], "error_rad": -0.1},
                     {"eye_mm": [1, 2, 3], "error_rad": 2},
                     {"eye_mm": [1, 2, 3], "error_rad": None}):
            viewer.send_json({"type": "look"} | look)
            self.assertEqual(viewer.receive_json("error")["code"], "bad_message", look)
        viewer.send_binary(b"??")
        self.assertEqual(viewer.receive_json("error")["code"], "bad_frame")

    def test_ack_of_a_frame_never_sent_is_a_bad_sequence(self):
        viewer = Viewer(self.port, "block")
        viewer.settled()
        viewer.send_binary(header(ACK, 0, sequence=12345))
        self.assertEqual(viewer.receive_json("error")["code"], "bad_sequence")


class BadUpgrades(LiveTest):
    def reject(self, path, protocol, status, code, headers=()):
        with self.assertRaises(Rejected) as rejected:
            WebSocket(self.port, path, protocol, headers)
        self.assertEqual(rejected.exception.status, status)
        self.assertEqual(rejected.exception.body["error"]["code"], code)

    def test_unknown_session_is_404(self):
        self.reject("/v1/sessions/nobody/agent", "kerf.agent.v1", 404, "unknown_session")
        self.reject("/v1/sessions/nobody/view", "kerf.view.v1", 404, "unknown_session")

    def test_wrong_sub_protocol_is_400(self):
        self.reject("/v1/sessions/block/agent", "kerf.view.v1", 400, "bad_protocol")
        self.reject("/v1/sessions/block/agent", "kerf.agent.v9", 400, "bad_protocol")
        self.reject("/v1/sessions/block/view", None, 400, "bad_protocol")

    def test_foreign_origin_is_403(self):
        self.reject("/v1/sessions/block/view", "kerf.view.v1", 403, "bad_origin",
                    ["Origin: https://evil.example"])

    def test_own_origin_is_accepted(self):
        WebSocket(self.port, "/v1/sessions/block/view", "kerf.view.v1",
                  [f"Origin: http://127.0.0.1:{self.port}"]).close()

    def test_other_paths_are_404(self):
        self.reject("/v1/sessions/block/spy", "kerf.view.v1", 404, "not_found")

    def test_plain_get_of_a_websocket_path_is_426(self):
        status, body = self.server.http.json("GET", "/v1/sessions/block/agent")
        self.assertEqual((status, body["error"]["code"]), (426, "upgrade_required"))

    def test_motion_before_hello_is_rejected(self):
        silent = Agent(self.port, "block", hello=False)
        silent.move([(0, 0, 0)])
        self.assertEqual(silent.receive_json("error")["code"], "no_hello")

    def test_missing_hello_ends_the_connection(self):
        silent = Agent(self.port, "block", hello=False)
        error = silent.receive_json("error")
        self.assertEqual((error["code"], error["fatal"]), ("no_hello", True))
        with self.assertRaises(Closed):
            silent.receive(5)

    def test_hello_with_unknown_tool_may_be_repeated(self):
        agent = Agent(self.port, "block", hello=False)
        agent.send_json({"type": "hello", "name": "Ada", "tool": 42})
        self.assertEqual(agent.receive_json("error")["code"], "unknown_tool")
        agent.send_json({"type": "hello", "name": "Ada", "color": "red"})
        self.assertEqual(agent.receive_json("error")["code"], "bad_message")
        agent.send_json({"type": "hello", "name": "Ada", "tool": 2})
        self.assertEqual(agent.receive_json("welcome")["session"], "block")


class BadHttp(LiveTest):
    def error(self, status, code, method, path, body=None, headers=None):
        answer, content = self.server.http.json(method, path, body, headers)
        self.assertEqual((answer, content["error"]["code"]), (status, code), content)
        self.assertTrue(content["error"]["reason"])
        return content["error"]

    def test_scenes_with_mistakes(self):
        self.error(400, "bad_scene", "POST", "/v1/sessions", "{")
        self.error(400, "bad_scene", "POST", "/v1/sessions", "")
        for pitch in (0, -1, "fine", 1e-9, None):
            scene = json.loads(json.dumps(SCENE))
            scene["accuracy"]["pitch_mm"] = pitch
            self.error(400, "bad_scene", "POST", "/v1/sessions", json.dumps(scene))
        self.assertEqual(len(self.server.http.json("GET", "/v1/sessions")[1]["sessions"]), 1)

    def test_scene_cannot_read_files_of_the_server(self):
        scene = dict(SCENE, obstacles=[{"shape": "stl", "file": "/etc/passwd"}])
        self.error(400, "bad_scene", "POST", "/v1/sessions", json.dumps(scene))

    def test_session_ids_are_safe(self):
        for bad in ("..", "a/b", "%2e%2e%2fx", "Upper", "a" * 65, "a%00b"):
            status, _ = self.server.http.json("POST", f"/v1/sessions?id={bad}", json.dumps(SCENE))
            self.assertEqual(status, 400, bad)
        self.error(409, "session_exists", "POST", "/v1/sessions?id=block", json.dumps(SCENE))

    def test_unknown_resources(self):
        self.error(404, "unknown_session", "GET", "/v1/sessions/nobody")
        self.error(404, "unknown_session", "DELETE", "/v1/sessions/nobody")
        self.error(404, "unknown_session", "GET", "/v1/sessions/nobody/model.stl")
        self.error(404, "not_found", "GET", "/v1/sessions/block/model.exe")
        self.error(404, "unknown_program", "GET", "/v1/sessions/block/programs/7")
        self.error(404, "not_found", "GET", "/../../etc/passwd")
        self.error(404, "not_found", "GET", "/%2e%2e/%2e%2e/etc/passwd")
        self.error(400, "bad_target", "GET", "/%zz")
        self.error(405, "bad_method", "PUT", "/v1/sessions/block")

    def test_programs_with_mistakes_name_line_and_word(self):
        url = "/v1/sessions/block/programs?pace=fast&name=bad.ngc"
        text = "G21 G90 T1 M6\nG1 X1 F100\nG987 X2\nM2\n"
        error = self.error(400, "bad_program", "POST", url, text)
        self.assertEqual(error["line"], 3)
        self.assertIn("G987", error["reason"])
        url = "/v1/sessions/block/programs"
        self.error(400, "bad_program", "POST", url + "?name=x.doc", "G0")
        self.error(400, "bad_pace", "POST", url + "?pace=warp", "G0")
        self.error(400, "bad_rate", "POST", url + "?sample_hz=nan", "G0")
        self.error(400, "bad_dialect", "POST", url + "?dialect=klartext", "G0")
        self.assertEqual(self.server.info()["motions"], 0)

    def test_a_program_is_read_in_the_dialect_that_is_named(self):
        url = "/v1/sessions/block/programs?name=jump.nc&dialect="
        text = "G21 G90 T1 M6\nIF [1 EQ 1] GOTO 10\nN10 G1 X1 F100\nM30\n"
        self.assertEqual(self.error(400, "bad_program", "POST", url + "linuxcnc", text)["line"], 2)
        status, program = self.server.http.json("POST", url + "fanuc", text)
        self.assertEqual(status, 202, program)

    def test_oversize_scene_is_413(self):
        self.error(413, "too_large", "POST", "/v1/sessions", " " * (1 << 20) + "{}")

    def test_foreign_page_cannot_change_anything(self):
        self.error(403, "bad_origin", "DELETE", "/v1/sessions/block",
                   headers={"Origin": "https://evil.example"})

    def test_garbage_instead_of_http_is_400(self):
        with socket.create_connection(("127.0.0.1", self.port), timeout=10) as raw:
            raw.sendall(b"\x16\x03\x01garbage\r\n\r\n")
            self.assertIn(b"400", raw.recv(4096))
        with socket.create_connection(("127.0.0.1", self.port), timeout=10) as raw:
            raw.sendall(b"GET / HTTP/1.1\r\nX: " + b"a" * 9000 + b"\r\n\r\n")
            self.assertIn(b"431", raw.recv(4096))
        self.assertEqual(self.server.http.request("GET", "/healthz")[0], 200)

    def test_slow_request_times_out(self):
        with socket.create_connection(("127.0.0.1", self.port), timeout=20) as raw:
            raw.sendall(b"GET / HTTP/1.1\r\n")
            self.assertEqual(raw.recv(4096), b"")


if __name__ == "__main__":
    run_tests()
