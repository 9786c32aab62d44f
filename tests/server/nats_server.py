# SPDX-License-Identifier: Apache-2.0
"""Starts and stops a real nats-server with JetStream for the tests, and asks its JetStream."""
import json
import os
import shutil
import signal
import socket
import subprocess

from kept_logs import path_of
from waiting import eventually

PROGRAM = shutil.which("nats-server") or shutil.which("nats-server", path="/usr/sbin")


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Nats:
    def __init__(self, folder, *more):
        self.folder, self.port, self.more = folder, free_port(), more
        self.url = f"nats://127.0.0.1:{self.port}"
        self.process = None
        self.start()

    def start(self):
        with open(path_of("nats"), "wb") as log:
            self.process = subprocess.Popen(
                [PROGRAM, "-js", "-sd", self.folder, "-a", "127.0.0.1", "-p", str(self.port),
                 *self.more],
                stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        eventually(self.answers, "nats-server does not answer")

    def answers(self):
        assert self.process.poll() is None, "nats-server has ended"
        try:
            socket.create_connection(("127.0.0.1", self.port), timeout=1).close()
            return True
        except OSError:
            return False

    def stop(self, how=signal.SIGTERM):
        if self.process.poll() is None:
            self.process.send_signal(how)
            self.process.wait(timeout=30)

    def request(self, subject, payload=b"", timeout=30):
        """Publishes a message and returns the answer, an object: of JetStream, or of a stream."""
        with socket.create_connection(("127.0.0.1", self.port), timeout=timeout) as link:
            lines = link.makefile("rb")
            link.sendall(b'CONNECT {"verbose":false}\r\nSUB answer 1\r\n' +
                         f"PUB {subject} answer {len(payload)}\r\n".encode() + payload + b"\r\n")
            for line in lines:
                if line.startswith(b"MSG "):
                    return json.loads(lines.read(int(line.split()[-1])))
        raise OSError("nats-server has closed the connection")

    def bytes_of(self, stream):
        """What a stream has on the disk; 0 if there is none."""
        answer = self.request(f"$JS.API.STREAM.INFO.{stream}")
        return answer["state"]["bytes"] if "state" in answer else 0

    def delete(self, stream):
        return self.request(f"$JS.API.STREAM.DELETE.{stream}")


class Trio:
    """Three nats-servers that form a cluster; ready when JetStream has a leader."""

    def __init__(self, folder):
        ports = {f"n{n}": free_port() for n in range(3)}
        routes = ",".join(f"nats://127.0.0.1:{port}" for port in ports.values())
        self.servers = {}
        for name, port in ports.items():
            path = os.path.join(folder, "nats-" + name)
            self.servers[name] = Nats(path, "--name", name, "--cluster_name", "trio", "--cluster",
                                      f"nats://127.0.0.1:{port}", "--routes", routes)
        self.url = ",".join(server.url for server in self.servers.values())
        eventually(lambda: "streams" in self.request("$JS.API.INFO"),
                   "the three nats-servers have elected no leader", 60, 0.2)

    def request(self, subject, payload=b""):
        """As that of Nats, of any that answers."""
        for server in list(self.servers.values()):
            try:
                return server.request(subject, payload, 2)
            except OSError:
                continue
        return {}

    def leader(self, stream):
        """The name of the server that leads a stream."""
        return self.request(f"$JS.API.STREAM.INFO.{stream}")["cluster"]["leader"]

    def kill(self, name):
        self.servers.pop(name).stop(signal.SIGKILL)

    def stop(self):
        for server in self.servers.values():
            server.stop()
