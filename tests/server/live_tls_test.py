# SPDX-License-Identifier: Apache-2.0
"""TLS: the real server with certificates of an authority that the test makes, and the real agent."""
import json
import os
import shutil
import signal
import socket
import ssl
import subprocess
import tempfile
import unittest

from kept_logs import keep, run_tests
from live_agent_test import AGENT, rows
from live_server import SCENE, Server
from wire_client import Agent, WebSocket

ADMIN = "0123456789abcdef0123456789abcdef"
BEARER = {"Authorization": "Bearer " + ADMIN}


def make_key(folder, name):
    """Returns the arguments of openssl for a new key."""
    return ["-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-keyout",
            os.path.join(folder, name + ".key")]


def openssl(*words):
    subprocess.run(["openssl", *words], check=True, capture_output=True)


def certify(folder, name):
    """Writes NAME.pem and NAME.key: a certificate of the authority ca.pem, or that authority."""
    path = os.path.join(folder, name)
    if name == "ca":
        return openssl("req", "-x509", *make_key(folder, name), "-out", path + ".pem", "-days", "2",
                       "-subj", "/CN=Authority of the test")
    with open(path + ".ext", "w", encoding="ascii") as file:
        file.write("subjectAltName=DNS:localhost,IP:127.0.0.1\n")
    openssl("req", "-new", *make_key(folder, name), "-out", path + ".csr", "-subj", "/CN=" + name)
    return openssl("x509", "-req", "-in", path + ".csr", "-CA", os.path.join(folder, "ca.pem"),
                   "-CAkey", os.path.join(folder, "ca.key"), "-CAcreateserial", "-out",
                   path + ".pem", "-days", "2", "-extfile", path + ".ext")


class TlsAgent(Agent):
    def __init__(self, port, tls):
        WebSocket.__init__(self, port, "/v1/sessions/block/agent", "kerf.agent.v1",
                           [f"Authorization: Bearer {ADMIN}"], tls=tls)
        self.sequence, self.time_us = 0, 1_000_000
        self.send_json({"type": "hello", "name": "Ada", "tool": 1})
        self.welcome = self.receive_json("welcome")
        self.epoch = self.welcome["epoch"]


class Tls(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="kerf-test-")
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        for name in ("ca", "good", "next"):
            certify(self.folder, name)
        self.client = ssl.create_default_context(cafile=self.path("ca.pem"))
        self.install("good.pem", "good.key")
        self.server = Server(self.path("data"), "--tls-cert", self.path("used.pem"), "--tls-key",
                             self.path("used.key"), tls=self.client,
                             environment={"KERF_ADMIN_TOKEN": ADMIN})
        self.ask("POST", "/v1/sessions?id=block", json.dumps(SCENE), 201)

    def tearDown(self):
        while WebSocket.opened:
            WebSocket.opened.pop().close()
        status, log = self.server.stop()
        self.assertEqual(status, 0, log)

    def path(self, name):
        return os.path.join(self.folder, name)

    def install(self, certificate, key):
        """Replaces the certificate and the key that the server reads."""
        for name, used in ((certificate, "used.pem"), (key, "used.key")):
            shutil.copyfile(self.path(name), self.path(used))

    def ask(self, method, path, body=None, status=200):
        got, answer = self.server.http.json(method, path, body, BEARER)
        self.assertEqual(got, status, answer)
        return answer

    def run_agent(self, url, *more):
        """Cuts rows; returns what the agent states of its link."""
        done = subprocess.run(
            [AGENT, "--server", url, "--session", "block", "--device",
             "replay:" + self.path("rows.csv"), "--tool", "2", "--status-json", "-", *more],
            capture_output=True, text=True, timeout=60, env={**os.environ, "KERF_TOKEN": ADMIN})
        keep("agent", done.stderr)
        self.assertNotIn(ADMIN, done.stderr)
        self.assertEqual(done.returncode, 0, done.stderr)
        link = json.loads(done.stdout)["link"]
        self.assertEqual((link["unanswered"], link["not_durable"], link["errors"]), (0, 0, {}))
        return link

    def test_a_real_agent_cuts_over_tls_as_it_does_without_and_doctor_finds_the_server(self):
        with open(self.path("rows.csv"), "w", encoding="ascii") as file:
            file.write(rows(240.0))
        url = f"https://localhost:{self.server.port}"
        for more, text in ((("--ca", self.path("ca.pem")), "is healthy; round trip"),
                           ((), "unknown authority")):
            done = subprocess.run([AGENT, "doctor", "--seconds", "0.1", "--server", url, *more],
                                  capture_output=True, text=True, timeout=60)
            self.assertIn(text, done.stdout)
        plain = Server(self.path("plain"))
        plain.create()
        link = self.run_agent(f"http://127.0.0.1:{plain.port}")
        self.assertFalse(link["udp"]["asked"])
        self.assertEqual(link["udp"]["datagrams_sent"], 0)
        link = self.run_agent(url, "--ca", self.path("ca.pem"), "--udp")
        # The keys for the datagrams were sent over TLS.
        self.assertTrue(link["udp"]["offered"])
        self.assertGreater(link["udp"]["samples"], 0)
        info = self.ask("GET", "/v1/sessions/block")
        self.assertGreater(info["removed_volume_mm3"], 100)
        self.assertEqual(info["state_hash"], plain.hash())
        plain.stop()

    def serial(self):
        with self.client.wrap_socket(socket.create_connection(("127.0.0.1", self.server.port)),
                                     server_hostname="localhost") as stream:
            return stream.getpeercert()["serialNumber"]

    def test_a_certificate_is_replaced_without_dropping_a_connection(self):
        agent = TlsAgent(self.server.port, self.client)
        agent.move([(0, 0, 5)])
        agent.result()
        first = self.serial()
        self.install("next.pem", "good.key")
        self.server.process.send_signal(signal.SIGHUP)
        self.assertRegex(self.server.log_line("SIGHUP"), "nothing is changed.*mismatch")
        self.assertEqual(self.serial(), first)
        self.install("next.pem", "next.key")
        self.server.process.send_signal(signal.SIGHUP)
        self.assertIn("new connections", self.server.log_line("SIGHUP"))
        self.assertNotEqual(self.serial(), first)
        agent.move([(1, 0, 5)])
        agent.result()  # over the earlier connection


if __name__ == "__main__":
    run_tests()
