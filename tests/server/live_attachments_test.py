# SPDX-License-Identifier: Apache-2.0
"""Rights, reserved regions and target parts move with a session to the server that goes on with it."""
import json
import os
import signal
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import nats_server  # noqa: E402
from cluster_servers import Cluster  # noqa: E402
from kept_logs import run_tests  # noqa: E402
from hands import Holder, bearer, spiral  # noqa: E402
from live_server import SCENE, until  # noqa: E402
from wire_client import Rejected, WebSocket  # noqa: E402

STL = """solid t
facet normal 0 0 0
outer loop
vertex 0 0 0
vertex 0 1 0
vertex 1 0 0
endloop
endfacet
endsolid t
"""
SESSION = "/v1/sessions/block"


class Move(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="kerf-test-")
        self.addCleanup(folder.cleanup)
        self.token_file = os.path.join(folder.name, "admin")
        self.cluster = Cluster(folder.name)
        self.addCleanup(self.cluster.end)
        self.a = self.start("a")
        with open(self.token_file, encoding="ascii") as file:
            self.admin = file.read().strip()
        self.ask(self.a, "POST", "/v1/sessions?id=block&here=1", self.admin, json.dumps(SCENE))

    def tearDown(self):
        while WebSocket.opened:
            WebSocket.opened.pop().close()

    def start(self, name, *more):
        return self.cluster.start(name, "--admin-token-file", self.token_file, *more)

    def ask(self, server, method, path, token, body=None, status=None):
        got, answer = server.http.json(method, path, body, bearer(token))
        if status is None:
            self.assertEqual(got // 100, 2, answer)
        else:
            self.assertEqual(got, status, answer)
        return answer

    def invite(self, server, role, **query):
        words = "".join(f"&{name}={value}" for name, value in query.items())
        return self.ask(server, "POST", f"{SESSION}/invitations?role={role}{words}", self.admin)

    def redeem(self, server, token, name):
        """The cookie of a pass that is given for an invitation."""
        status, headers, body = server.http.request("POST", f"{SESSION}/join?name={name}",
                                                    headers=bearer(token))
        self.assertEqual(status, 201, body)
        return headers["set-cookie"].split(";")[0]

    def watch(self, server, cookie):
        """Who watches with a pass is, as the welcome says."""
        viewer = WebSocket(server.port, f"{SESSION}/view", "kerf.view.v1", ["Cookie: " + cookie])
        viewer.send_json({"type": "hello", "name": "Mallory"})
        welcome = viewer.receive_json("welcome")
        return welcome["role"], [p["name"] for p in welcome["participants"]]

    def is_here(self, server):
        status, info = server.http.json("GET", SESSION, None, bearer(self.admin))
        return status == 200 and info["paused"] is None and not info["followed"]

    def wait_for_copy(self, server):
        """What was attached before a motion is copied with it, or before.

        A program adds records all the time, so all of them are never copied on a slow machine.
        """
        agent = Holder(server.port, self.admin)
        agent.move([(-8, -8, -1), (-7, -8, -1)])
        self.assertGreater(agent.result()["removed"], 0)
        agent.close()

        last = self.ask(server, "GET", SESSION, self.admin)["state_sequence"]

        def is_copied():
            copied = self.ask(server, "GET", SESSION, self.admin)["copied"]  # null after a start
            return copied is not None and copied["fault"] is None and copied["record"] >= last

        until(self, is_copied, True)

    def check_reserved(self, server, token):
        agent = Holder(server.port, token, "Grace")
        agent.move([(5, 5, -1), (6, 5, -1)])
        self.assertEqual(agent.receive_json("error")["code"], "reserved")
        agent.close()

    def line(self, server, program):
        return self.ask(server, "GET", program["url"], self.admin)["line"]

    def check_program(self, server, text, first):
        """The program that ran is shown as stopped; the one that had ended is not."""
        listed = self.ask(server, "GET", f"{SESSION}/programs", self.admin)["programs"]
        self.assertEqual([(p["name"], p["state"]) for p in listed], [("job.ngc", "cancelled")])
        line = listed[0]["line"]
        # It went on between the look and the end of the server.
        self.assertGreaterEqual(line, first - 1)
        self.assertIn(f"all before line {line} is cut", listed[0]["error"])
        status, _, source = server.http.request("GET", listed[0]["url"] + "/source", None,
                                                bearer(self.admin))
        self.assertEqual((status, source.decode()), (200, text))

    def check_move(self, how, *more):
        """What people can do at the next server, after its owner has ended so."""
        link = self.invite(self.a, "watcher")["token"]
        unused = self.invite(self.a, "owner", uses=1)["token"]
        named = self.invite(self.a, "sculptor", name="Grace")["token"]
        revoked = self.invite(self.a, "sculptor")
        eve, gone = self.redeem(self.a, link, "Eve"), self.redeem(self.a, revoked["token"], "Bob")
        self.ask(self.a, "POST", f"{SESSION}/regions?min_mm=2,2,-5&max_mm=9,9,0", self.admin)
        part = self.ask(self.a, "POST", f"{SESSION}/targets?name=t.stl&shift_mm=1,2,3", named, STL)
        text = spiral(3000)
        self.ask(self.a, "POST", f"{SESSION}/programs?name=short.ngc&pace=fast", self.admin,
                 spiral(3))
        job = self.ask(self.a, "POST", f"{SESSION}/programs?name=job.ngc&speed=0.1", self.admin,
                       text)
        b = self.start("b", *more)
        # Who shows a token is sent to the session, at the other server; strangers are not.
        until(self, lambda: b.http.request("GET", SESSION, headers=bearer(named))[0] in (200, 307),
              True)
        self.assertEqual(b.http.request("GET", SESSION)[0], 401)
        self.ask(self.a, "DELETE", f"{SESSION}/invitations/{revoked['id']}", self.admin)
        until(self, lambda: self.line(self.a, job) > 4, True)
        first = self.line(self.a, job)  # before the wait: it is in the copy after it
        self.wait_for_copy(self.a)
        self.cluster.stop("a", how)
        until(self, lambda: self.is_here(b), True)
        self.assertEqual(self.watch(b, eve), ("watcher", ["Eve"]))
        for token in (revoked["token"], gone.split("=")[1]):
            self.ask(b, "GET", SESSION, token, status=401)
        with self.assertRaises(Rejected) as rejected:
            self.watch(b, gone)
        self.assertEqual(rejected.exception.status, 401)
        self.assertEqual(self.watch(b, self.redeem(b, unused, "Zoe"))[0], "owner")
        self.ask(b, "POST", f"{SESSION}/join", unused, status=409)
        self.check_reserved(b, named)
        self.assertEqual(self.ask(b, "GET", f"{SESSION}/targets", named)["targets"], [part])
        self.check_program(b, text, first)

    def test_after_a_kill(self):
        self.check_move(signal.SIGKILL)

    def test_after_a_planned_stop(self):
        self.check_move(signal.SIGTERM)

    def test_after_a_kill_with_a_server_that_follows(self):
        self.check_move(signal.SIGKILL, "--follow", "all")

    def test_who_follows_knows_passes_and_ends_those_that_are_revoked(self):
        invitation = self.invite(self.a, "watcher")
        b = self.start("b", "--follow", "all")
        eve = self.redeem(self.a, invitation["token"], "Eve")

        def status_at_b():
            return b.http.request("GET", SESSION, headers={"Cookie": eve})[0]

        until(self, status_at_b, 200)
        viewer = WebSocket(b.port, f"{SESSION}/view", "kerf.view.v1", ["Cookie: " + eve])
        viewer.send_json({"type": "hello"})
        self.assertEqual(viewer.receive_json("welcome")["role"], "watcher")
        self.ask(self.a, "DELETE", f"{SESSION}/invitations/{invitation['id']}", self.admin)
        error = viewer.receive_json("error")
        self.assertEqual((error["code"], error["reason"]),
                         ("removed", "the invitation was revoked"))
        # The follower does not know it any more: the owner has the last word.
        until(self, status_at_b, 307)
        self.assertEqual(self.a.http.request("GET", SESSION, headers={"Cookie": eve})[0], 401)


if __name__ == "__main__":
    if nats_server.PROGRAM is None:
        print("skipped: nats-server is not installed")
        sys.exit(77)
    run_tests()
