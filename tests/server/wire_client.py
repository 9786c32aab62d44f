# SPDX-License-Identifier: Apache-2.0
"""A client of kerf-server for the tests: HTTP of the standard library, its own WebSocket and wire codec.

It shares no code with the server, so that the tests detect mistakes of the server's codec.
"""
import base64
import http.client
import json
import os
import socket
import struct
import time

MAGIC = 0x3146524B
MOTION, RESULT, MESH, TOOLS, ACK, PING, PONG = 1, 2, 3, 4, 5, 6, 7
CUTTING = 1
# Time limits are for a server at full speed. A sanitizer's build multiplies them by this.
PATIENCE = float(os.environ.get("KERF_TEST_PATIENCE", "1"))
WAIT_S = 30 * PATIENCE


class Closed(Exception):
    """The server closed the connection; `code` is the WebSocket close code, if it sent one."""

    def __init__(self, code=None):
        super().__init__(f"closed with {code}")
        self.code = code


class Rejected(Exception):
    """The server answered the upgrade with an HTTP status other than 101."""

    def __init__(self, status, body):
        super().__init__(f"{status}: {body}")
        self.status = status
        self.body = body


class Http:
    def __init__(self, port, tls=None, host="127.0.0.1"):
        self.port, self.host = port, host
        self.tls = tls  # an ssl.SSLContext, for a server with TLS

    def request(self, method, path, body=None, headers=None):
        if self.tls:
            connection = http.client.HTTPSConnection(self.host, self.port, timeout=2 * WAIT_S,
                                                     context=self.tls)
        else:
            connection = http.client.HTTPConnection(self.host, self.port, timeout=2 * WAIT_S)
        connection.request(method, path, body=body, headers=headers or {})
        response = connection.getresponse()
        data = response.read()
        connection.close()
        return response.status, dict((k.lower(), v) for k, v in response.getheaders()), data

    def json(self, method, path, body=None, headers=None):
        status, _, data = self.request(method, path, body, headers)
        return status, json.loads(data)


class WebSocket:
    opened = []  # keeps the sockets of a test from being garbage-collected

    def __init__(self, port, path, protocol, headers=(), tls=None):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=WAIT_S)
        if tls:
            self.socket = tls.wrap_socket(self.socket, server_hostname="127.0.0.1")
        WebSocket.opened.append(self)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        key = base64.b64encode(os.urandom(16)).decode()
        lines = [f"GET {path} HTTP/1.1", f"Host: 127.0.0.1:{port}",
                 "Upgrade: websocket",
                 "Connection: Upgrade", f"Sec-WebSocket-Key: {key}", "Sec-WebSocket-Version: 13"]
        if protocol:
            lines.append(f"Sec-WebSocket-Protocol: {protocol}")
        lines += list(headers)
        self.socket.sendall(("\r\n".join(lines) + "\r\n\r\n").encode())
        self.buffer = b""
        while b"\r\n\r\n" not in self.buffer:
            self._fill()
        head, self.buffer = self.buffer.split(b"\r\n\r\n", 1)
        status = int(head.split()[1])
        self.headers = head.decode().lower()
        if status != 101:
            length = int(self.headers.split("content-length:")[1].split()[0])
            while len(self.buffer) < length:
                self._fill()
            raise Rejected(status, json.loads(self.buffer[:length]))

    def _fill(self):
        data = self.socket.recv(65536)
        if not data:
            raise Closed()
        self.buffer += data

    def _take(self, count):
        while len(self.buffer) < count:
            self._fill()
        data, self.buffer = self.buffer[:count], self.buffer[count:]
        return data

    def send_frame(self, opcode, payload):
        length = len(payload)
        head = bytes([0x80 | opcode])
        if length < 126:
            head += bytes([0x80 | length])
        elif length < 65536:
            head += bytes([0x80 | 126]) + struct.pack(">H", length)
        else:
            head += bytes([0x80 | 127]) + struct.pack(">Q", length)
        mask = os.urandom(4)
        repeated = (mask * (length // 4 + 1))[:length]
        masked = int.from_bytes(payload, "big") ^ int.from_bytes(repeated, "big")
        self.socket.sendall(head + mask + masked.to_bytes(length, "big"))

    def send_text(self, text):
        self.send_frame(1, text.encode() if isinstance(text, str) else text)

    def send_json(self, message):
        self.send_text(json.dumps(message))

    def send_binary(self, data):
        self.send_frame(2, data)

    def receive(self, timeout=WAIT_S):
        """Returns the next message: ("text", dict) or ("binary", bytes)."""
        end = time.monotonic() + timeout
        while True:
            self.socket.settimeout(max(0.01, end - time.monotonic()))  # pings do not extend it
            first, second = self._take(2)
            length = second & 127
            if length == 126:
                length = struct.unpack(">H", self._take(2))[0]
            elif length == 127:
                length = struct.unpack(">Q", self._take(8))[0]
            payload = self._take(length)
            opcode = first & 15
            if opcode == 8:
                raise Closed(struct.unpack(">H", payload[:2])[0] if payload else None)
            if opcode == 9:
                self.send_frame(10, payload)
            elif opcode == 1:
                return "text", json.loads(payload)
            elif opcode == 2:
                return "binary", payload

    def receive_json(self, kind, timeout=WAIT_S):
        """Skips to the next JSON message of a type and returns it."""
        end = time.monotonic() + timeout
        while True:
            form, message = self.receive(max(0.01, end - time.monotonic()))
            if form == "text" and message["type"] == kind:
                return message

    def receive_binary(self, kind, timeout=WAIT_S):
        """Skips to the next binary message of a type; returns (header fields, payload)."""
        end = time.monotonic() + timeout
        while True:
            form, message = self.receive(max(0.01, end - time.monotonic()))
            if form == "binary" and message[4] == kind:
                return parse_header(message), message[32:]

    def close(self):
        self.socket.close()


def parse_header(frame):
    magic, kind, flags, header_bytes, payload, epoch, sequence, time_us = struct.unpack(
        "<IBBHIIQQ", frame[:32])
    assert magic == MAGIC and header_bytes == 32 and payload == len(frame) - 32
    return {"type": kind, "flags": flags, "epoch": epoch, "sequence": sequence, "time_us": time_us}


NEW_EPOCH = 2  # epoch of a new session: its journal was created and opened


def header(kind, payload_bytes, sequence=1, epoch=NEW_EPOCH):
    return struct.pack("<IBBHIIQQ", MAGIC, kind, 0, 32, payload_bytes, epoch, sequence, 0)


def sample(sequence, time_us, tip, axis=(0, 0, 1), tool=1, buttons=CUTTING):
    return struct.pack("<QQ3d3fIII", sequence, time_us, *tip, *axis, tool, buttons, 0)


def motion_frame(samples, epoch=NEW_EPOCH):
    payload = struct.pack("<II", len(samples), 0) + b"".join(samples)
    return header(MOTION, len(payload), epoch=epoch) + payload


def parse_result(payload):
    names = ("agent_sequence", "agent_time_us", "motions", "fx", "fy", "fz", "tx", "ty", "tz",
             "area", "dx", "dy", "dz", "cx", "cy", "cz", "specific", "removed", "status",
             "reserved", "kx", "ky", "kz", "turnaround_us")
    return dict(zip(names, struct.unpack("<3Q3f3ff3f3dffII3fI", payload[:120])))


class Agent(WebSocket):
    def __init__(self, port, session, name="Ada", tool=1, hello=True, **more):
        super().__init__(port, f"/v1/sessions/{session}/agent", "kerf.agent.v1")
        self.sequence = 0
        self.time_us = 1_000_000
        self.epoch = NEW_EPOCH
        if hello:
            self.send_json({"type": "hello", "name": name, "tool": tool, **more})
            self.welcome = self.receive_json("welcome")
            self.participant = self.welcome["participant"]
            self.epoch = self.welcome["epoch"]

    def move(self, tips, tool=1, buttons=CUTTING):
        """Sends one message with a sample per tip."""
        samples = []
        for tip in tips:
            self.sequence += 1
            self.time_us += 1000
            samples.append(sample(self.sequence, self.time_us, tip, tool=tool, buttons=buttons))
        self.send_binary(motion_frame(samples, self.epoch))

    def result(self, sequence=None):
        """Waits for the result that answers the given sample (or the last one sent)."""
        expected = sequence or self.sequence
        while True:
            result = parse_result(self.receive_binary(RESULT)[1])
            if result["agent_sequence"] >= expected:
                return result


class Viewer(WebSocket):
    def __init__(self, port, session, name="Grace", **more):
        super().__init__(port, f"/v1/sessions/{session}/view", "kerf.view.v1")
        self.send_json({"type": "hello", "name": name, **more})
        self.welcome = self.receive_json("welcome")
        self.participant = self.welcome["participant"]
        self.keeps_meshes = False
        self.meshes = {}  # if set: position and encoded mesh of each tile
        self.tools = []

    def take(self, timeout=WAIT_S):
        """Handles the next message as a viewer does; returns its type."""
        form, message = self.receive(timeout)
        if form == "text":
            self.last = message
            if message["type"] == "welcome":  # the tiles of another block follow
                self.meshes = {}
            return message["type"]
        fields = parse_header(message)
        if fields["type"] == MESH:
            if self.keeps_meshes:
                self.apply(message[32:])
            self.send_binary(header(ACK, 0, sequence=fields["sequence"],
                                    epoch=self.welcome["epoch"]))
        elif fields["type"] == TOOLS:
            count = struct.unpack("<I", message[32:36])[0]
            self.tools = [struct.unpack("<II3d3fI3f3ffI", message[40 + 80 * i:120 + 80 * i])
                          for i in range(count)]
        return fields["type"]

    def apply(self, glb):
        length = struct.unpack("<I", glb[12:16])[0]
        document = json.loads(glb[20:20 + length])
        for node in document["nodes"]:
            tile = node.get("extras", {}).get("tile")
            if tile is not None:
                self.meshes[tuple(tile)] = self.mesh_of(document, node, glb[28 + length:])

    @staticmethod
    def mesh_of(document, node, buffer):
        if "mesh" not in node:
            return None
        part = document["meshes"][node["mesh"]]["primitives"][0]
        coded = []
        for accessor in [*part["attributes"].values(), part["indices"]]:
            view = document["bufferViews"][document["accessors"][accessor]["bufferView"]]
            view = view["extensions"]["EXT_meshopt_compression"]
            coded.append(buffer[view["byteOffset"]:view["byteOffset"] + view["byteLength"]])
        return node["translation"], coded

    def settled(self, timeout=WAIT_S):
        """Handles messages until the state is settled; returns that state message."""
        end = time.monotonic() + timeout
        while True:
            kind = self.take(max(0.01, end - time.monotonic()))
            if kind == "state" and self.last["settled"]:
                return self.last
