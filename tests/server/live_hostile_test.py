# SPDX-License-Identifier: Apache-2.0
"""Hostile bytes on the server's port: tables of HTTP requests and WebSocket frames, each with the answer that it gets."""
import base64
import os
import resource
import socket
import struct

from kept_logs import run_tests
from live_server import LiveTest
from wire_client import Agent, Closed, Rejected, Viewer, WebSocket

HOST = b"Host: localhost\r\n"
GET = b"GET /healthz HTTP/1.1\r\n" + HOST
POST = b"POST /v1/sessions HTTP/1.1\r\n" + HOST
UPGRADE = (b"GET /v1/sessions/block/view HTTP/1.1\r\n" + HOST + b"Connection: Upgrade\r\n")
KEY = b"Sec-WebSocket-Key: " + base64.b64encode(bytes(16)) + b"\r\n"
VERSION = b"Sec-WebSocket-Version: 13\r\n"
PROTOCOL = b"Sec-WebSocket-Protocol: kerf.view.v1\r\n"
WEBSOCKET = b"Upgrade: websocket\r\n"
END = b"\r\n"

# Name, bytes, status of the answer; None: the connection is closed without one. Several statuses: any of them is correct.
HTTP = [
    ("nothing but a line break", b"\r\n\r\n", 400),
    ("no Host", b"GET /healthz HTTP/1.1\r\n\r\n", 400),
    ("two Hosts", GET + HOST + END, 400),
    ("an empty Host, as RFC 9112 allows", b"GET /healthz HTTP/1.1\r\nHost:\r\n\r\n", 200),
    ("a foreign Host", b"GET /healthz HTTP/1.1\r\nHost: evil.example\r\n\r\n", 421),
    ("a Host with a path", b"GET /healthz HTTP/1.1\r\nHost: localhost/evil\r\n\r\n", (400, 421)),
    ("a Host with an @", b"GET /healthz HTTP/1.1\r\nHost: localhost@evil.example\r\n\r\n", 421),
    ("a Host with a letter for a port", b"GET /healthz HTTP/1.1\r\nHost: localhost:x\r\n\r\n", (400, 421)),
    ("HTTP 1.0 without Host", b"GET /healthz HTTP/1.0\r\n\r\n", (200, 400)),
    ("HTTP 0.9", b"GET /healthz\r\n\r\n", 400),
    ("HTTP 2.0", b"GET /healthz HTTP/2.0\r\n" + HOST + END, (400, 505)),
    ("the preface of HTTP/2", b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", (400, 505)),
    ("a version of letters", b"GET /healthz HTTP/a.b\r\n" + HOST + END, 400),
    ("the hello of TLS", b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + bytes(40), 400),
    ("an unknown method", b"BREW /healthz HTTP/1.1\r\n" + HOST + END, 405),
    ("a method in lower case", b"get /healthz HTTP/1.1\r\n" + HOST + END, (400, 405)),
    ("an empty method", b" /healthz HTTP/1.1\r\n" + HOST + END, 400),
    ("a method with a bracket", b"GE(T /healthz HTTP/1.1\r\n" + HOST + END, 400),
    ("CONNECT", b"CONNECT evil.example:443 HTTP/1.1\r\n" + HOST + END, (400, 405)),
    ("TRACE", b"TRACE /healthz HTTP/1.1\r\n" + HOST + END, 405),
    ("OPTIONS of everything", b"OPTIONS * HTTP/1.1\r\n" + HOST + END, 400),
    ("PUT of a session", b"PUT /v1/sessions/block HTTP/1.1\r\n" + HOST + b"Content-Length: 0\r\n\r\n", 405),
    ("a target without a slash", b"GET healthz HTTP/1.1\r\n" + HOST + END, 400),
    ("an empty target", b"GET  HTTP/1.1\r\n" + HOST + END, 400),
    ("a space in the target", b"GET /health z HTTP/1.1\r\n" + HOST + END, 400),
    ("a control character in the target", b"GET /he\x01lthz HTTP/1.1\r\n" + HOST + END, 400),
    ("an encoded zero in the target", b"GET /healthz%00 HTTP/1.1\r\n" + HOST + END, (400, 404)),
    ("a percent sign without digits", b"GET /%zz HTTP/1.1\r\n" + HOST + END, 400),
    ("a percent sign at the end", b"GET /% HTTP/1.1\r\n" + HOST + END, 400),
    ("a path out of the folder", b"GET /../../etc/passwd HTTP/1.1\r\n" + HOST + END, (400, 404)),
    ("an encoded path out of the folder", b"GET /%2e%2e/%2e%2e/etc/passwd HTTP/1.1\r\n" + HOST + END, (400, 404)),
    ("an encoded slash", b"GET /..%2f..%2fetc%2fpasswd HTTP/1.1\r\n" + HOST + END, (400, 404)),
    ("a backslash", b"GET /..\\..\\etc\\passwd HTTP/1.1\r\n" + HOST + END, (400, 404)),
    ("a hidden file", b"GET /.git/config HTTP/1.1\r\n" + HOST + END, 404),
    ("bytes that are not UTF-8 in the target", b"GET /\xff\xfe HTTP/1.1\r\n" + HOST + END, (400, 404)),
    ("a target of 3000 bytes", b"GET /" + b"a" * 3000 + b" HTTP/1.1\r\n" + HOST + END, (400, 414)),
    ("a target of 20 kB", b"GET /" + b"a" * 20000 + b" HTTP/1.1\r\n" + HOST + END, (400, 414, 431)),
    ("a header of 20 kB", GET + b"X: " + b"a" * 20000 + b"\r\n\r\n", 431),
    ("2000 headers", GET + b"X: y\r\n" * 2000 + END, 431),
    ("a header without a colon", GET + b"nonsense\r\n\r\n", 400),
    ("a header without a name", GET + b": value\r\n\r\n", 400),
    ("a space before the colon", GET + b"X : y\r\n\r\n", 400),
    ("a header name in parentheses", GET + b"(X): y\r\n\r\n", 400),
    ("a zero in a header", GET + b"X: a\x00b\r\n\r\n", 400),
    ("a lone carriage return in a header", GET + b"X: a\rb\r\n\r\n", 400),
    ("a lone line feed in a header", GET + b"X: a\nY: b\r\n\r\n", 400),
    ("a negative length", POST + b"Content-Length: -1\r\n\r\n", 400),
    ("a length with a plus", POST + b"Content-Length: +5\r\n\r\nhello", 400),
    ("a length of letters", POST + b"Content-Length: ten\r\n\r\n", 400),
    ("a length in hexadecimal", POST + b"Content-Length: 0x5\r\n\r\nhello", 400),
    ("a length beyond 64 bits", POST + b"Content-Length: 99999999999999999999\r\n\r\n", 400),
    ("two different lengths", POST + b"Content-Length: 5\r\nContent-Length: 6\r\n\r\nhello!", 400),
    ("a list of lengths", POST + b"Content-Length: 5, 6\r\n\r\nhello!", 400),
    ("length and chunks", POST + b"Content-Length: 5\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n", 400),
    ("an unknown transfer coding", POST + b"Transfer-Encoding: gzip\r\n\r\n", (400, 411, 501)),
    ("chunked twice", POST + b"Transfer-Encoding: chunked, chunked\r\n\r\n0\r\n\r\n", (400, 411, 501)),
    ("chunked, then another coding", POST + b"Transfer-Encoding: chunked, gzip\r\n\r\n0\r\n\r\n", (400, 411, 501)),
    ("a body in chunks: its length must be known", POST + b"Transfer-Encoding: chunked\r\n\r\n2\r\n{}\r\n0\r\n\r\n", 411),
    ("a body in chunks where none is expected", GET + b"Transfer-Encoding: chunked\r\n\r\n5\r\nhello\r\n", 411),
    ("an unknown transfer coding where no body is expected", GET + b"Transfer-Encoding: xchunked\r\n\r\n", 411),
    ("a chunk of letters", POST + b"Transfer-Encoding: chunked\r\n\r\nxyz\r\nhello", 411),
    ("a huge chunk", POST + b"Transfer-Encoding: chunked\r\n\r\n7FFFFFFFFFFFFFFF\r\n", 411),
    ("a body of 2 MB for a scene", POST + b"Content-Length: 2000000\r\n\r\n", 413),
    ("a body of a terabyte", POST + b"Content-Length: 1000000000000\r\n\r\n", 413),
    ("a program of a terabyte",
     b"POST /v1/sessions/block/programs HTTP/1.1\r\n" + HOST + b"Content-Length: 1000000000000\r\n\r\n", 413),
    ("an empty scene", POST + b"Content-Length: 0\r\n\r\n", 400),
    ("a scene that is not UTF-8", POST + b"Content-Length: 4\r\n\r\n\xff\xfe\xfd\xfc", 400),
    ("a scene of brackets", POST + b"Content-Length: 100000\r\n\r\n" + b"[" * 100000, 400),
    ("a scene of numbers that overflow",
     POST + b"Content-Length: 25\r\n\r\n" + b'{"name":1e999,"stock":1e9}'[:25], 400),
    ("a body for a GET", GET + b"Content-Length: 5\r\n\r\nhello", (200, 413)),
    ("a body of 1 MB for a GET", GET + b"Content-Length: 1000000\r\n\r\n", 413),
    ("a foreign Origin that changes something", POST + b"Origin: https://evil.example\r\nContent-Length: 0\r\n\r\n", 403),
    ("the Origin null that changes something", POST + b"Origin: null\r\nContent-Length: 0\r\n\r\n", 403),
    ("a range of letters", GET + b"Range: bytes=a-b\r\n\r\n", 200),
    ("a range beyond 64 bits", GET + b"Range: bytes=99999999999999999999-\r\n\r\n", (200, 416)),
    ("a hundred ranges", GET + b"Range: bytes=" + b"0-0," * 100 + b"1-1\r\n\r\n", 200),
    ("a wild If-None-Match", GET + b'If-None-Match: "' + b"a" * 1000 + b", *\r\n\r\n", 200),
    ("a broken query", b"GET /v1/sessions/block/model.stl?encoding=%f HTTP/1.1\r\n" + HOST + END, 400),
    ("a session id of dots", b"GET /v1/sessions/.. HTTP/1.1\r\n" + HOST + END, (400, 404)),
    ("a program number beyond 64 bits",
     b"GET /v1/sessions/block/programs/99999999999999999999 HTTP/1.1\r\n" + HOST + END, 404),
    ("an upgrade to something else", UPGRADE + b"Upgrade: h2c\r\n" + KEY + VERSION + END, (400, 426)),
    ("an upgrade without a key", UPGRADE + WEBSOCKET + VERSION + PROTOCOL + END, (400, 426)),
    ("an upgrade with a short key",
     UPGRADE + WEBSOCKET + VERSION + PROTOCOL + b"Sec-WebSocket-Key: abc\r\n\r\n", (400, 426)),
    ("an upgrade of an old version",
     UPGRADE + WEBSOCKET + KEY + PROTOCOL + b"Sec-WebSocket-Version: 8\r\n\r\n", (400, 426)),
    ("an upgrade by POST",
     UPGRADE.replace(b"GET", b"POST") + WEBSOCKET + KEY + VERSION + PROTOCOL + END, (400, 405, 426)),
    ("an upgrade without the protocol", UPGRADE + WEBSOCKET + KEY + VERSION + END, 400),
]


def frame(first, payload, mask=True, length=None):
    """A WebSocket frame; `length` replaces the bytes of its length field."""
    size = len(payload)
    if length is None:
        length = (bytes([size]) if size < 126 else b"\x7e" + struct.pack(">H", size) if size < 65536
                  else b"\x7f" + struct.pack(">Q", size))
    head = bytes([first, length[0] | (0x80 if mask else 0)]) + length[1:]
    return head + (bytes(4) if mask else b"") + payload  # a mask of zero leaves the payload as it is


# Name, bytes, code with which the server closes; None: with any.
FRAMES = [
    ("an unmasked text", frame(0x81, b"{}", mask=False), 1002),
    ("an unmasked ping", frame(0x89, b"", mask=False), 1002),
    *((f"reserved bit {bit:#x}", frame(0x81 | bit, b"{}"), 1002) for bit in (0x10, 0x20, 0x40)),
    *((f"opcode {code}", frame(0x80 | code, b""), 1002) for code in (3, 4, 5, 6, 7, 11, 12, 13, 14, 15)),
    ("a continuation of nothing", frame(0x80, b"x"), 1002),
    ("a text inside a fragmented text", frame(0x01, b"{") + frame(0x81, b"}"), 1002),
    ("a fragmented ping", frame(0x09, b"x"), 1002),
    ("a ping of 126 bytes", frame(0x89, b"x" * 126), 1002),
    ("a close of 126 bytes", frame(0x88, b"\x03\xe8" + b"x" * 124), 1002),
    ("a close of one byte", frame(0x88, b"\x03"), 1002),
    ("a close with code 999", frame(0x88, b"\x03\xe7"), 1002),
    ("a close with code 1005", frame(0x88, b"\x03\xed"), 1002),
    ("a close with code 1006", frame(0x88, b"\x03\xee"), 1002),
    ("a close whose reason is not UTF-8", frame(0x88, b"\x03\xe8\xff\xfe"), None),
    ("a length of 16 bits for five bytes", frame(0x82, b"x" * 5, length=b"\x7e\x00\x05"), 1002),
    ("a length of 64 bits for five bytes", frame(0x82, b"x" * 5, length=b"\x7f" + bytes(7) + b"\x05"), 1002),
    ("a negative length", frame(0x82, b"", length=b"\x7f\xff" + b"\xff" * 7), (1002, 1009)),
    ("a length of 4 EB", frame(0x82, b"", length=b"\x7f\x40" + bytes(7)), 1009),
    ("a message of 70 kB", frame(0x82, b"x" * 70000), 1009),
    ("fragments of 70 kB together", frame(0x02, b"x" * 35000) + frame(0x80, b"x" * 35000), 1009),
    ("a text that is not UTF-8", frame(0x81, b"\xff\xfe"), None),
]


class Hostile(LiveTest):
    def exchange(self, request):
        """Sends bytes and the end of the stream; returns the status of the first answer, or None."""
        answer = self.answers(request)
        return int(answer.split()[1]) if answer.startswith(b"HTTP/") else None

    def answers(self, request):
        with socket.create_connection(("127.0.0.1", self.port), timeout=20) as peer:
            answer = b""
            try:
                peer.sendall(request)
                peer.shutdown(socket.SHUT_WR)
                while chunk := peer.recv(65536):
                    answer += chunk
            except ConnectionError:
                pass
            return answer

    def test_what_follows_an_unknown_transfer_coding_is_no_request(self):
        # A proxy that takes it for the body would let it pass.
        for method in (b"GET", b"OPTIONS"):
            first = (method + b" /v1/sessions HTTP/1.1\r\n" + HOST + b"Origin: http://localhost\r\n" +
                     b"Transfer-Encoding: xchunked\r\n\r\n")
            self.assertEqual(self.answers(first + GET + END).count(b"HTTP/1.1 "), 1, method)

    def test_each_request_gets_its_answer(self):
        agent = Agent(self.port, "block")
        for name, request, expected in HTTP:
            with self.subTest(name):
                status = self.exchange(request)
                allowed = expected if isinstance(expected, tuple) else (expected,)
                self.assertIn(status, allowed)
        agent.move([(0, 0, -1)])
        agent.move([(1, 0, -1)])
        self.assertGreater(agent.result()["removed"], 0)

    def test_each_frame_closes_its_own_connection(self):
        agent = Agent(self.port, "block")
        for name, data, expected in FRAMES:
            with self.subTest(name):
                viewer = Viewer(self.port, "block", "Mallory")
                code = self.code_of_the_close(viewer, data)
                if expected is not None:
                    allowed = expected if isinstance(expected, tuple) else (expected,)
                    self.assertIn(code, allowed)
        agent.move([(0, 0, -1)])
        agent.move([(1, 0, -1)])
        self.assertGreater(agent.result()["removed"], 0)

    def code_of_the_close(self, viewer, data):
        try:
            viewer.socket.sendall(data)
            while True:
                viewer.receive(10)
        except Closed as closed:
            return closed.code
        except ConnectionError:
            return None

    def test_two_hundred_slow_requests_delay_nobody(self):
        slow = [socket.create_connection(("127.0.0.1", self.port), timeout=20) for _ in range(200)]
        try:
            for n, peer in enumerate(slow):
                request = (GET, POST + b"Content-Length: 1000\r\n\r\n", UPGRADE + WEBSOCKET)[n % 3]
                peer.sendall(request[:5 + n % (len(request) - 5)])
            agent, viewer = Agent(self.port, "block"), Viewer(self.port, "block")
            for step in range(20):
                for peer in slow:
                    peer.sendall(b"a")
                agent.move([(step * 0.1, 0, -1)])
                agent.result()
                self.assertEqual(self.server.http.request("GET", "/healthz")[0], 200)
            viewer.settled()
            self.assertEqual(self.server.info()["motions"], 19)
        finally:
            for peer in slow:
                peer.close()

    def test_a_client_with_thousands_of_connections_keeps_nobody_out(self):
        limit, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        count = 4200  # the server has at most 4096
        if hard < count + 100:
            self.skipTest("too few files may be open")
        resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
        agent, idle = Agent(self.port, "block"), []
        try:
            # The first one is a client of another network that sends its next request later.
            patient = socket.create_connection(("127.0.0.1", self.port), 20, ("127.0.0.2", 0))
            idle.append(patient)
            for _ in range(count):
                idle.append(socket.create_connection(("127.0.0.1", self.port), timeout=20))
                idle[-1].sendall(b"GET /healthz")
            for peer in (patient, socket.create_connection(("127.0.0.1", self.port), 20, ("127.0.0.3", 0))):
                idle.append(peer)
                peer.sendall(GET + END)
                self.assertIn(b"200 OK", peer.recv(4096))
            agent.move([(0, 0, -1)])
            agent.move([(1, 0, -1)])
            self.assertGreater(agent.result()["removed"], 0)
        finally:
            for peer in idle:
                peer.close()
            resource.setrlimit(resource.RLIMIT_NOFILE, (limit, hard))


if __name__ == "__main__":
    run_tests()
