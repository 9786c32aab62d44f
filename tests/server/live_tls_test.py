# SPDX-License-Identifier: Apache-2.0
"""TLS: the real server with certificates of an authority that the test makes, and the real agent."""
import json
import os
import re
import signal
import socket
import ssl
import subprocess
import tempfile
import time
import unittest

from kept_logs import keep, run_tests
from live_agent_test import AGENT, rows
from live_server import SCENE, Server, until
from wire_client import Agent, WebSocket

ADMIN = "0123456789abcdef0123456789abcdef"
HALF_OPEN = 20


def make_key(folder, name):
    """Returns the arguments of openssl for a new key."""
    return ["-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-keyout",
            os.path.join(folder, name + ".key")]


def openssl(*words):
    subprocess.run(["openssl", *words], check=True, capture_output=True)


def certify(folder, name, subjects="DNS:localhost,IP:127.0.0.1", days=2):
    """Writes NAME.pem and NAME.key: a certificate of the authority ca.pem, or that authority."""
    path = os.path.join(folder, name)
    if name == "ca":
        return openssl("req", "-x509", *make_key(folder, name), "-out", path + ".pem", "-days", "2",
                       "-subj", "/CN=Authority of the test")
    with open(path + ".ext", "w", encoding="ascii") as file:
        file.write(f"subjectAltName={subjects}\n")
    openssl("req", "-new", *make_key(folder, name), "-out", path + ".csr", "-subj", "/CN=" + name)
    return openssl("x509", "-req", "-in", path + ".csr", "-CA", os.path.join(folder, "ca.pem"),
                   "-CAkey", os.path.join(folder, "ca.key"), "-CAcreateserial", "-out",
                   path + ".pem", "-days", str(days), "-extfile", path + ".ext")


class TlsAgent(Agent):
    def __init__(self, port, tls):
        WebSocket.__init__(self, port, "/v1/sessions/block/agent", "kerf.agent.v1",
                           [f"Authorization: Bearer {ADMIN}"], tls=tls)
        self.sequence, self.time_us = 0, 1_000_000
        self.send_json({"type": "hello", "name": "Ada", "tool": 1})
        self.welcome = self.receive_json("welcome")
        self.epoch = self.welcome["epoch"]


class Tls(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="kerf-test-")
        for name, more in (("ca", {}), ("good", {}), ("next", {}), ("old", {"days": -1}),
                           ("other", {"subjects": "DNS:other.example"})):
            certify(cls.folder.name, name, **more)
        with open(cls.path("pose.csv"), "w", encoding="ascii") as file:
            file.write(rows(240.0))
        cls.client = ssl.create_default_context(cafile=cls.path("ca.pem"))
        os.environ["KERF_ADMIN_TOKEN"] = ADMIN
        os.environ["KERF_TOKEN"] = ADMIN
        cls.install("good")
        cls.server = Server(cls.path("data"), "--tls-cert", cls.path("used.pem"), "--tls-key",
                            cls.path("used.key"), tls=cls.client)
        cls.port = cls.server.port
        status, _ = cls.ask("POST", "/v1/sessions?id=block", json.dumps(SCENE))
        assert status == 201
        # They are closed while the other tests run.
        cls.half_open = [cls.begin_handshake() for _ in range(HALF_OPEN)]
        end = time.monotonic() + 4
        while cls.connections() < HALF_OPEN:  # they count
            assert time.monotonic() < end

    @classmethod
    def tearDownClass(cls):
        del os.environ["KERF_ADMIN_TOKEN"], os.environ["KERF_TOKEN"]
        while WebSocket.opened:
            WebSocket.opened.pop().close()
        status, log = cls.server.stop()
        assert status == 0, log
        cls.folder.cleanup()

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder.name, name)

    @classmethod
    def install(cls, name):
        """Replaces the certificate and the key that the server reads."""
        for kind in (".pem", ".key"):
            with open(cls.path(name + kind), "rb") as source:
                with open(cls.path("used" + kind), "wb") as target:
                    target.write(source.read())

    @classmethod
    def ask(cls, method, path, body=None):
        return cls.server.http.json(method, path, body, {"Authorization": "Bearer " + ADMIN})

    @classmethod
    def begin_handshake(cls):
        half = socket.create_connection(("127.0.0.1", cls.port))
        half.sendall(b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03")  # of a hello of 512 bytes
        return half

    @classmethod
    def connections(cls):
        headers = {"Authorization": "Bearer " + ADMIN}
        text = cls.server.http.request("GET", "/metrics", headers=headers)[2].decode()
        return float(re.search(r'kerf_connections{kind="http"} ([0-9.e+]+)', text).group(1))

    def log_line(self, word):
        return self.server.log_line(word)

    def run_agent(self, port, *more, scheme="https", host="127.0.0.1", session="block"):
        return subprocess.Popen(
            [AGENT, "--server", f"{scheme}://{host}:{port}", "--session", session, "--device",
             "replay:" + self.path("pose.csv"), "--tool", "2", "--patience", "2", *more],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def test_a_real_agent_cuts_over_tls_as_it_does_without(self):
        plain = Server(self.path("plain"))
        hashes = []
        for server, scheme, more in ((plain, "http", ()),
                                     (self.server, "https", ("--ca", self.path("ca.pem"), "--udp"))):
            status, body = server.http.json("POST", "/v1/sessions?id=cut", json.dumps(SCENE),
                                            {"Authorization": "Bearer " + ADMIN})
            self.assertEqual(status, 201, body)
            agent = self.run_agent(server.port, "--status-json", "-", *more, scheme=scheme,
                                   session="cut")
            out, log = agent.communicate(timeout=60)
            keep("agent", log)
            self.assertEqual(agent.returncode, 0, log)
            link = json.loads(out)["link"]
            self.assertEqual((link["unanswered"], link["not_durable"], link["errors"]), (0, 0, {}))
            body = server.http.json("GET", "/v1/sessions/cut",
                                    headers={"Authorization": "Bearer " + ADMIN})[1]
            self.assertGreater(body["removed_volume_mm3"], 100)
            hashes.append(body["state_hash"])
        # The keys of the datagrams came through TLS.
        self.assertGreater(link["udp"]["samples"], 0)
        self.assertEqual(hashes[0], hashes[1])
        plain.stop()

    def test_nothing_older_than_tls_1_3_is_spoken(self):
        old = ssl.create_default_context(cafile=self.path("ca.pem"))
        old.maximum_version = ssl.TLSVersion.TLSv1_2
        with self.assertRaises(ssl.SSLError):
            old.wrap_socket(socket.create_connection(("127.0.0.1", self.port)),
                            server_hostname="127.0.0.1")
        with self.client.wrap_socket(socket.create_connection(("127.0.0.1", self.port)),
                                     server_hostname="localhost") as new:
            self.assertEqual(new.version(), "TLSv1.3")

    def test_the_agent_says_what_is_wrong_with_a_server(self):
        servers = {}
        for name in ("old", "other"):
            servers[name] = Server(self.path("data-" + name), "--tls-cert",
                                   self.path(name + ".pem"), "--tls-key", self.path(name + ".key"),
                                   tls=ssl._create_unverified_context())
        plain = Server(self.path("data-plain"))
        own = ("--ca", self.path("ca.pem"))
        cases = [
            ("has expired", self.run_agent(servers["old"].port, *own)),
            ("is not for 127.0.0.1", self.run_agent(servers["other"].port, *own)),
            ("unknown authority", self.run_agent(self.port)),
            ("use https://", self.run_agent(self.port, scheme="http")),
            ("does not speak TLS", self.run_agent(plain.port, *own)),
        ]
        for reason, agent in cases:
            log = keep("agent", agent.communicate(timeout=60)[1])
            self.assertEqual(agent.returncode, 1, log)
            self.assertIn(reason, log)
            self.assertNotIn(ADMIN, log)
        for server in (*servers.values(), plain):
            server.stop()

    def test_doctor_checks_a_server_with_tls(self):
        for more, text in ((("--ca", self.path("ca.pem")), "is healthy"), ((), "unknown authority")):
            done = subprocess.run([AGENT, "doctor", "--seconds", "0.1", "--server",
                                   f"https://localhost:{self.port}", *more],
                                  capture_output=True, text=True, timeout=60)
            self.assertIn(text, done.stdout)

    def serial(self):
        with self.client.wrap_socket(socket.create_connection(("127.0.0.1", self.port)),
                                     server_hostname="localhost") as stream:
            return stream.getpeercert()["serialNumber"]

    def test_a_certificate_is_replaced_without_dropping_a_connection(self):
        agent = TlsAgent(self.port, self.client)
        agent.move([(0, 0, 5)])
        agent.result()
        first = self.serial()
        # The last one stays while the new one is no certificate, has expired, or has another key, or
        # one that a server cannot read.
        openssl("pkey", "-in", self.path("next.key"), "-aes128", "-passout", "pass:secret", "-out",
                self.path("locked.key"))
        for name, key, why in (("pose.csv", "good.key", "no start line"), ("old.pem", "old.key", "has expired"),
                               ("next.pem", "good.key", "mismatch"), ("next.pem", "locked.key", "without one")):
            for source, kind in ((name, ".pem"), (key, ".key")):
                with open(self.path(source), "rb") as file:
                    bytes_read = file.read()
                with open(self.path("used" + kind), "wb") as file:
                    file.write(bytes_read)
            self.server.process.send_signal(signal.SIGHUP)
            self.assertRegex(self.log_line("SIGHUP"), "nothing is changed.*" + why)
            self.assertEqual(self.serial(), first)
        self.install("next")
        self.server.process.send_signal(signal.SIGHUP)
        self.assertIn("new connections", self.log_line("SIGHUP"))
        self.assertNotEqual(self.serial(), first)
        agent.move([(1, 0, 5)])
        agent.result()  # over the connection from before

    def test_a_certificate_that_has_expired_is_reported_at_the_start(self):
        with tempfile.TemporaryDirectory() as folder:
            server = Server(folder, "--tls-cert", self.path("old.pem"), "--tls-key",
                            self.path("old.key"), tls=ssl._create_unverified_context())
            headers = {"Authorization": "Bearer " + ADMIN}
            text = server.http.request("GET", "/metrics", headers=headers)[2].decode()
            self.assertLess(float(re.search(r"\nkerf_certificate_days_left (\S+)", text).group(1)), 0)
            status, log = server.stop()
            self.assertEqual(status, 0)
            self.assertRegex(log, r"old\.pem has expired: it is valid from 20\S+ \S+ UTC to 20\S+ \S+ UTC")
            self.assertIn("SIGHUP", log)
        text = self.server.http.request("GET", "/metrics", headers=headers)[2].decode()
        self.assertGreater(float(re.search(r"\nkerf_certificate_days_left (\S+)", text).group(1)), 0)

    def test_the_end_of_tcp_without_an_end_of_tls_loses_nothing(self):
        agent = TlsAgent(self.port, self.client)
        before = self.ask("GET", "/v1/sessions/block")[1]["motions"]
        for i in range(50):
            agent.move([(0.1 * i, 0, -1), (0.1 * i + 0.05, 0, -1)])
        end = socket.socket(fileno=os.dup(agent.socket.fileno()))
        end.shutdown(socket.SHUT_WR)
        end.close()
        until(self, lambda: self.ask("GET", "/v1/sessions/block")[1]["motions"] - before, 99)

    def test_slow_downloads_over_tls_do_not_fill_the_memory(self):
        scene = dict(SCENE, accuracy=dict(SCENE["accuracy"], pitch_mm=0.2))
        self.assertEqual(self.ask("POST", "/v1/sessions?id=fine", json.dumps(scene))[0], 201)
        # A surface of ball marks has many facets.
        lines = ["G21 G90 T1 M6"]
        for i in range(64):
            x, y = 5 * (i % 8) - 17, 5 * (i // 8) - 17
            lines += [f"G0 X{x} Y{y} Z5", f"G1 Z{-1 - i % 3} F3000", "G0 Z5"]
        status, program = self.ask("POST", "/v1/sessions/fine/programs?pace=fast",
                                   "\n".join(lines + ["M2"]))
        self.assertEqual(status, 202, program)
        path = f"/v1/sessions/fine/programs/{program['id']}"
        until(self, lambda: self.ask("GET", path)[1]["state"], "finished")
        request = (f"GET /v1/sessions/fine/model.stl HTTP/1.1\r\nHost: localhost\r\n"
                   f"Authorization: Bearer {ADMIN}\r\n\r\n").encode()
        self.server.http.request("GET", "/v1/sessions/fine/model.stl",
                                 headers={"Authorization": "Bearer " + ADMIN})  # makes the file
        readers = []
        before = self.memory()
        for _ in range(40):
            tcp = socket.socket()
            tcp.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            tcp.connect(("127.0.0.1", self.port))
            readers.append(self.client.wrap_socket(tcp, server_hostname="localhost"))
            readers[-1].sendall(request)
        first = [reader.recv(4096) for reader in readers]
        length = int(re.search(rb"Content-Length: ([0-9]+)", first[0]).group(1))
        self.assertGreater(length, 3_000_000)
        self.assertLess(self.memory() - before, 40 * length // 4)
        for reader in readers:
            reader.close()

    def memory(self):
        with open(f"/proc/{self.server.process.pid}/status", encoding="ascii") as file:
            return 1024 * int(re.search(r"VmRSS:\s+([0-9]+)", file.read()).group(1))

    def test_browsers_stay_with_tls(self):
        _, headers, _ = self.server.http.request("GET", "/healthz")
        self.assertIn("max-age=", headers["strict-transport-security"])
        # For localhost, other ports are other programs.
        _, headers, _ = self.server.http.request("GET", "/healthz", headers={"Host": "localhost"})
        self.assertNotIn("strict-transport-security", headers)
        token = self.ask("POST", "/v1/sessions/block/invitations?role=watcher")[1]["token"]
        _, headers, _ = self.server.http.request("POST", "/v1/sessions/block/join",
                                                 headers={"Authorization": "Bearer " + token})
        self.assertIn("; Secure", headers["set-cookie"])

    def test_z_half_a_handshake_counts_as_a_connection_and_is_closed_in_time(self):
        for half in self.half_open:
            half.settimeout(20)
            self.assertEqual(half.recv(100), b"")
            half.close()
        until(self, lambda: self.connections() < HALF_OPEN, True)


if __name__ == "__main__":
    run_tests()
