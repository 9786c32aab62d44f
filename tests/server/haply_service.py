# SPDX-License-Identifier: Apache-2.0
"""Emulates the Haply Inverse Service for the tests: its simulation channel, a WebSocket on which one
state answers each message, with an Inverse3 in a simulated hand and a Wireless VerseGrip. It ignores
names that it does not know without a word, as the service does."""
import base64
import hashlib
import json
import socket
import struct
import threading
import time

GUID = b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11"


class Inverse3Model:
    """An Inverse3 in a simulated hand with a VerseGrip, as the service states them; no transport.

    `aim(t)` returns where the hand wants the cursor at the time t, in m. `word`: the name of the force
    that it takes, `vector` (3.5) or `values` (3.1); `session_id`: whether its messages state one, as
    those of 3.5 do."""

    def __init__(self, aim=lambda t: (0.0, 0.0, 0.0), orientation=(0, 1, 0, 0), word="vector",
                 session_id=True):
        self.word, self.session_id, self.ignored, self.error = word, session_id, 0, None
        self.aim, self.orientation = aim, orientation  # w, x, y, z
        self.calibrated, self.button, self.grips = True, False, True
        self.more_buttons = {"b": False, "c": False}
        self.forces, self.profiles, self.faults = [], [], []  # forces: (seconds, (x, y, z) in N)
        self.odd = []  # messages, as text, that each replace one of the next states

    def newest_force(self):
        return self.forces[-1][1] if self.forces else None

    def begin(self, now_s):
        """A client has connected; returns the first message for it."""
        self.is_first, self.last_s = True, now_s
        self.at, self.speed = list(self.aim(0)), [0.0] * 3
        return self.state((0, 0, 0), config=True)

    def answer(self, message, now_s):
        """Returns the message that answers one of the client."""
        if self.is_first != ("session" in message):
            self.faults.append("the session is configured in the first message, and only there")
        if self.is_first:
            self.profiles.append(message["session"]["configure"]["profile"]["name"])
        self.is_first = False
        device, = message["inverse3"]
        assert device["device_id"] == "049D"
        sent = device["commands"]["set_cursor_force"].get(self.word)
        self.ignored += sent is None
        force = tuple(sent[n] for n in "xyz") if sent else (0, 0, 0)
        self.forces.append((now_s, force))
        self.move(force, min(now_s - self.last_s, 0.01), now_s)
        self.last_s = now_s
        return self.odd.pop(0) if self.odd else self.state(force)

    def move(self, force, dt, now_s):
        """A mass of 0.3 kg, held by 1 N/mm with some damping."""
        goal = self.aim(now_s)
        steps = max(1, round(dt / 0.0005))
        for _ in range(steps):
            for i in range(3):
                pull = 1000 * (goal[i] - self.at[i]) - 25 * self.speed[i] + force[i]
                self.speed[i] += pull / 0.3 * dt / steps
                self.at[i] += self.speed[i] * dt / steps

    def state(self, force, config=False):
        zero = dict.fromkeys("xyz", 0.0)
        inverse3 = {"device_id": "049D",
                    "state": {"cursor_position": dict(zip("xyz", self.at)), "cursor_velocity": zero,
                              "current_cursor_force": dict(zip("xyz", force)),
                              "control_mode": "force"},
                    "status": {"calibrated": self.calibrated, "in_use": True, "ready": True}}
        grip = {"device_id": "6157",
                "state": {"orientation": dict(zip("wxyz", self.orientation)), "hall": 0,
                          "buttons": {"a": self.button, **self.more_buttons}},
                "status": {"connected": True}}
        if config:
            inverse3["config"] = {"type": "inverse3", "handedness": "right"}
            grip["config"] = {"type": "wireless_verse_grip"}
        message = {"inverse3": [inverse3], "wireless_verse_grip": [grip] if self.grips else []}
        if self.session_id:
            message["session_id"] = 7
        if self.error:
            message["error"] = self.error
        return message


class Service(Inverse3Model):
    """The same as a service, for one client after the other."""

    def __init__(self, *more):
        super().__init__(*more)
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.url = f"ws://127.0.0.1:{self.listener.getsockname()[1]}"
        self.peers = []
        threading.Thread(target=self._listen, daemon=True).start()

    def stop(self):
        self.listener.shutdown(socket.SHUT_RDWR)
        self.listener.close()
        for peer in self.peers:
            try:
                peer.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass

    def _listen(self):
        while True:
            try:
                peer = self.listener.accept()[0]
            except OSError:
                return
            self.peers.append(peer)
            threading.Thread(target=self._serve, args=(peer,), daemon=True).start()

    def _serve(self, peer):
        try:
            with peer, peer.makefile("rb") as stream:
                self._handshake(peer, stream)
                self._send(peer, self.begin(time.monotonic()))
                while (message := self._receive(stream)) is not None:
                    self._send(peer, self.answer(message, time.monotonic()))
        except (OSError, ValueError, LookupError, struct.error) as fault:
            if isinstance(fault, (ValueError, LookupError)):
                self.faults.append(repr(fault))

    def _handshake(self, peer, stream):
        key = b""
        while (line := stream.readline().strip()):
            if line.lower().startswith(b"sec-websocket-key:"):
                key = line.split(b":")[1].strip()
        accept = base64.b64encode(hashlib.sha1(key + GUID).digest()).decode()
        peer.sendall(f"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\n"
                     f"Connection: Upgrade\r\nSec-WebSocket-Accept: {accept}\r\n\r\n".encode())

    @staticmethod
    def _send(peer, message):
        data = json.dumps(message).encode()
        peer.sendall(struct.pack(">BBH", 0x81, 126, len(data)) + data)

    @staticmethod
    def _receive(stream):
        head = stream.read(2)
        if len(head) < 2 or head[0] != 0x81:
            return None
        if not head[1] & 0x80:
            raise ValueError("a client masks its frames")
        size = head[1] & 0x7F
        if size == 126:
            size, = struct.unpack(">H", stream.read(2))
        mask = stream.read(4)
        return json.loads(bytes(b ^ mask[i & 3] for i, b in enumerate(stream.read(size))))
