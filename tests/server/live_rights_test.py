# SPDX-License-Identifier: Apache-2.0
"""Tests tokens, invitations and what owners may do to others, with the real server."""
import json
import os
import subprocess
import tempfile
import unittest

from kept_logs import run_tests
from live_server import PROGRAM, SCENE as BLOCK, Server
from wire_client import Agent, Closed, Rejected, Viewer, WebSocket

AGENT = os.environ["KERF_AGENT"]
SCENE = json.dumps(BLOCK)


def bearer(token):
    return {"Authorization": "Bearer " + token}


class Holder(Agent):
    """An agent that presents a token when it asks for its WebSocket."""

    def __init__(self, port, token, name="Ada"):
        WebSocket.__init__(self, port, "/v1/sessions/block/agent", "kerf.agent.v1",
                           [f"Authorization: Bearer {token}"])
        self.sequence = 0
        self.time_us = 1_000_000
        self.send_json({"type": "hello", "name": name})
        self.welcome = self.receive_json("welcome")
        self.participant = self.welcome["participant"]
        self.epoch = self.welcome["epoch"]


class Rights(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="kerf-test-")
        self.file = os.path.join(self.folder.name, "admin")
        self.start()
        with open(self.file, encoding="ascii") as file:
            self.admin = file.read().strip()
        status, _ = self.ask("POST", "/v1/sessions?id=block", self.admin, SCENE)
        self.assertEqual(status, 201)

    def start(self, *more):
        self.server = Server(os.path.join(self.folder.name, "data"), "--admin-token-file",
                             self.file, *more)
        self.port = self.server.port

    def tearDown(self):
        while WebSocket.opened:
            WebSocket.opened.pop().close()
        status, log = self.server.stop()
        self.assertEqual(status, 0, log)
        # Neither the administrator's token nor any other one is in the log.
        self.assertNotIn(self.admin, log)
        self.assertNotIn("kerf_", log)
        self.folder.cleanup()

    def ask(self, method, path, token="", body=None, headers=None):
        headers = dict(headers or {}, **(bearer(token) if token else {}))
        return self.server.http.json(method, path, body, headers)

    def invite(self, role, **query):
        words = "".join(f"&{name}={value}" for name, value in query.items())
        status, body = self.ask("POST", f"/v1/sessions/block/invitations?role={role}{words}",
                                self.admin)
        self.assertEqual(status, 201, body)
        return body

    def assert_rejected(self, status, port, path, *headers):
        with self.assertRaises(Rejected) as rejected:
            kind = path.rsplit("/", 1)[1]
            WebSocket(port, path, f"kerf.{kind}.v1", list(headers))
        self.assertEqual(rejected.exception.status, status)

    def test_without_a_token_there_is_nothing_but_the_page(self):
        for path in ("/v1/sessions", "/v1/sessions/block", "/v1/sessions/other", "/metrics",
                     "/v1/sessions/block/model.stl"):
            status, body = self.ask("GET", path)
            self.assertEqual((status, body["error"]["code"]), (401, "no_token"), path)
        self.assertEqual(self.ask("GET", "/healthz")[0], 200)
        for kind in ("agent", "view"):
            self.assert_rejected(401, self.port, f"/v1/sessions/block/{kind}")

    def test_the_body_of_a_stranger_is_not_read(self):
        # 64 MB are announced and none is sent: the answer comes all the same.
        status, body = self.server.http.json(
            "POST", "/v1/files", None, {"Content-Length": str(60 << 20)})
        self.assertEqual((status, body["error"]["code"]), (401, "no_token"))

    def test_a_browser_exchanges_the_link_for_a_cookie(self):
        link = self.invite("watcher")["link"]
        token = link.split("#invite=")[1]
        status, headers, _ = self.server.http.request(
            "POST", "/v1/sessions/block/join?name=Eve", headers=bearer(token))
        self.assertEqual(status, 201)
        cookie = headers["set-cookie"].split(";")[0]
        viewer = WebSocket(self.port, "/v1/sessions/block/view", "kerf.view.v1",
                           ["Cookie: " + cookie])
        viewer.send_json({"type": "hello", "name": "Mallory"})
        welcome = viewer.receive_json("welcome")
        self.assertEqual(welcome["role"], "watcher")
        self.assertNotIn("carve", welcome["may"])
        self.assertEqual([p["name"] for p in welcome["participants"]], ["Eve"])
        self.assert_rejected(403, self.port, "/v1/sessions/block/agent", "Cookie: " + cookie)
        self.assertEqual(self.ask("DELETE", "/v1/sessions/block", headers={"Cookie": cookie})[0],
                         403)

    def test_an_owner_mutes_and_removes(self):
        owner = self.invite("owner")["token"]
        ada = Holder(self.port, self.invite("sculptor", name="Ada")["token"])
        grace = Holder(self.port, self.invite("sculptor", name="Grace")["token"])
        person = f"/v1/sessions/block/participants/{ada.participant}"
        self.assertEqual(self.ask("POST", person + "?muted=1", owner)[0], 200)
        ada.move([(0, 0, -1), (1, 0, -1)])
        self.assertEqual(ada.receive_json("error")["code"], "muted")
        self.assertEqual(self.ask("POST", person + "?muted=0", owner)[0], 200)
        ada.move([(2, 0, -1)])
        self.assertGreater(ada.result()["removed"], 0)
        self.assertEqual(self.ask("DELETE", person + "?reason=enough", owner)[0], 200)
        error = ada.receive_json("error")
        self.assertEqual((error["code"], error["reason"], error["fatal"]),
                         ("removed", "enough", True))
        with self.assertRaises(Closed):
            while True:
                ada.receive()
        grace.move([(0, 5, -1), (1, 5, -1)])
        self.assertGreater(grace.result()["removed"], 0)

    def test_a_revoked_and_an_expired_invitation_end_connections(self):
        invitation = self.invite("watcher")
        brief = self.invite("watcher", hours=5 / 3600)  # long enough to join with it
        sockets = []
        for token in (invitation["token"], brief["token"]):
            socket = WebSocket(self.port, "/v1/sessions/block/view", "kerf.view.v1",
                               [f"Authorization: Bearer {token}"])
            socket.send_json({"type": "hello"})
            socket.receive_json("welcome")
            sockets.append(socket)
        # Opened before the invitation ends, and silent until then.
        spare = WebSocket(self.port, "/v1/sessions/block/view", "kerf.view.v1",
                          [f"Authorization: Bearer {invitation['token']}"])
        self.ask("DELETE", f"/v1/sessions/block/invitations/{invitation['id']}", self.admin)
        spare.send_json({"type": "hello"})
        self.assertEqual(spare.receive_json("error")["code"], "not_allowed")
        self.assertEqual(sockets[0].receive_json("error")["code"], "removed")
        self.assertEqual(sockets[1].receive_json("error")["code"], "not_allowed")
        for token in (invitation["token"], brief["token"]):
            self.assertEqual(self.ask("GET", "/v1/sessions/block", token)[1]["error"]["code"],
                             "bad_token")

    def test_only_a_trusted_proxy_says_what_its_clients_use(self):
        said = {"X-Forwarded-For": "203.0.113.9", "X-Forwarded-Proto": "https",
                "X-Forwarded-Host": "kerf.example"}
        for trusted in (False, True):
            if trusted:
                self.assertEqual(self.server.stop()[0], 0)
                self.start("--trust-proxy", "10.0.0.1", "--trust-proxy", "127.0.0.0/8",
                           "--allow-host", "kerf.example")
            status, body = self.ask("POST", "/v1/sessions/block/invitations?role=watcher",
                                    self.admin, headers=said)
            self.assertEqual(status, 201, body)
            start = "https://kerf.example" if trusted else f"http://127.0.0.1:{self.port}"
            self.assertEqual(body["url"], start + body["link"])
            _, headers, _ = self.server.http.request("POST", "/v1/sessions/block/join",
                                                     headers=dict(said, **bearer(body["token"])))
            self.assertEqual("; Secure" in headers["set-cookie"], trusted)
        environment = {k: v for k, v in os.environ.items() if k != "KERF_ADMIN_TOKEN"}
        done = subprocess.run([PROGRAM, "--listen", "127.0.0.1:0", "--data", self.folder.name,
                               "--trust-proxy", "127.0.0.1"], env=environment,
                              capture_output=True, text=True, timeout=60, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("--admin-token-file", done.stderr)

    def test_grants_last_over_a_restart(self):
        token = self.invite("sculptor", name="Ada")["token"]
        self.assertEqual(self.server.stop()[0], 0)
        self.start()
        agent = Holder(self.port, token, "Somebody")
        self.assertEqual(agent.welcome["role"], "sculptor")
        everybody = self.ask("GET", "/v1/sessions/block", token)[1]["participants"]
        self.assertEqual([(p["name"], p["role"]) for p in everybody], [("Ada", "sculptor")])

    def test_a_backup_has_the_rights_too(self):
        token = self.invite("watcher", name="Eve")["token"]
        data, to = (os.path.join(self.folder.name, name) for name in ("data", "copies"))
        done = subprocess.run([PROGRAM, "backup", data, to], capture_output=True, text=True,
                              timeout=60, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(os.stat(os.path.join(to, "rights.db")).st_mode & 0o077, 0)
        copy = Server(to, "--admin-token-file", self.file)
        self.addCleanup(copy.stop)
        status, _ = copy.http.json("GET", "/v1/sessions/block", headers=bearer(token))
        self.assertEqual(status, 200)

    def test_the_agent_takes_its_token_from_a_file_or_the_environment(self):
        file = os.path.join(self.folder.name, "link")
        link = "https://kerf.example" + self.invite("sculptor")["link"]
        with open(file, "w", encoding="ascii") as out:
            out.write(link + "\n")
        command = [AGENT, "--server", f"http://127.0.0.1:{self.port}", "--session", "block",
                   "--device", "sim", "--duration", "0.2", "--patience", "5"]
        plain = {key: value for key, value in os.environ.items() if key != "KERF_TOKEN"}
        done = subprocess.run([*command, "--token-file", file], env=plain, capture_output=True,
                              text=True, timeout=60, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        done = subprocess.run(command, env=dict(plain, KERF_TOKEN=link.split("=")[-1]),
                              capture_output=True, text=True, timeout=60, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        done = subprocess.run(command, env=plain, capture_output=True, text=True, timeout=60,
                              check=False)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("needs a token", done.stderr)


class OpenServer(unittest.TestCase):
    def test_guests_watch_and_carve_and_destroy_nothing(self):
        with tempfile.TemporaryDirectory(prefix="kerf-test-") as folder:
            scene = os.path.join(folder, "scene.json")
            with open(scene, "w", encoding="utf-8") as out:
                out.write(SCENE)
            server = Server(os.path.join(folder, "data"), "--open", "--scene", scene)
            try:
                viewer = Viewer(server.port, "block")
                self.assertEqual(viewer.welcome["role"], "guest")
                agent = Agent(server.port, "block")
                agent.move([(0, 0, -1), (0.1, 0, -1)])
                self.assertGreater(agent.result()["removed"], 0)
                for method, path in (("DELETE", "/v1/sessions/block"), ("POST", "/v1/sessions"),
                                     ("POST", "/v1/files"), ("GET", "/metrics"),
                                     ("POST", "/v1/sessions/block/programs?name=x.ngc"),
                                     ("DELETE", f"/v1/sessions/block/participants/{agent.participant}"),
                                     ("POST", "/v1/sessions/block/invitations?role=owner")):
                    self.assertEqual(server.http.json(method, path, "x")[0], 403, path)
                for socket in (viewer, agent):
                    socket.close()
            finally:
                self.assertEqual(server.stop()[0], 0)

    def test_a_server_that_others_can_reach_needs_rights(self):
        with tempfile.TemporaryDirectory(prefix="kerf-test-") as folder:
            done = subprocess.run([PROGRAM, "--listen", "0.0.0.0:0", "--data", folder],
                                  env={k: v for k, v in os.environ.items()
                                       if k != "KERF_ADMIN_TOKEN"},
                                  capture_output=True, text=True, timeout=60, check=False)
            self.assertEqual(done.returncode, 1)
            for word in ("0.0.0.0", "--admin-token-file", "--open"):
                self.assertIn(word, done.stderr)
            environment = dict(os.environ, KERF_ADMIN_TOKEN="too-short")
            done = subprocess.run([PROGRAM, "--listen", "127.0.0.1:0", "--data", folder],
                                  env=environment, capture_output=True, text=True, timeout=60,
                                  check=False)
            self.assertEqual(done.returncode, 1)
            self.assertNotIn("too-short", done.stderr)

    def test_a_server_without_rights_rejects_what_a_proxy_forwards(self):
        with tempfile.TemporaryDirectory(prefix="kerf-test-") as folder:
            server = Server(folder)
            try:
                status, body = server.http.json("GET", "/v1/sessions", None,
                                                {"X-Forwarded-For": "203.0.113.7"})
                self.assertEqual((status, body["error"]["code"]), (403, "forwarded"))
                self.assertEqual(server.http.json("GET", "/v1/sessions")[0], 200)
            finally:
                server.stop()


if __name__ == "__main__":
    run_tests()
