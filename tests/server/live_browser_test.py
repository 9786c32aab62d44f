# SPDX-License-Identifier: Apache-2.0
"""Tests what a browser may do for a page: Host, Origin, CORS and the headers of responses."""
import http.client
import os
import socket
import tempfile

from kept_logs import run_tests
from live_server import LiveTest, Server
from wire_client import Rejected, WebSocket


class Browser(LiveTest):
    def setUp(self):
        super().setUp()
        self.web = tempfile.TemporaryDirectory(prefix="kerf-test-web-")
        with open(os.path.join(self.web.name, "index.html"), "w", encoding="utf-8") as page:
            page.write("<!doctype html><title>page</title>")
        self.data = tempfile.TemporaryDirectory(prefix="kerf-test-")
        self.named = Server(self.data.name, "--web", self.web.name, "--allow-host", "workshop",
                            "--allow-origin", "https://kerf.example")
        self.named.create()

    def tearDown(self):
        self.assertEqual(self.named.stop()[0], 0)
        self.web.cleanup()
        self.data.cleanup()
        super().tearDown()

    def request(self, method, path, port=None, **headers):
        connection = http.client.HTTPConnection("127.0.0.1", port or self.named.port, timeout=30)
        names = {name.replace("_", "-"): value for name, value in headers.items()}
        connection.request(method, path, headers=names)
        response = connection.getresponse()
        body = response.read()
        connection.close()
        return response.status, {k.lower(): v for k, v in response.getheaders()}, body

    def test_a_name_that_a_foreign_dns_points_here_is_rejected(self):
        for host in ("evil.example", f"evil.example:{self.port}"):
            for method, path in (("GET", "/v1/sessions"), ("DELETE", "/v1/sessions/block"),
                                 ("GET", "/"), ("GET", "/healthz")):
                status, _, body = self.request(method, path, self.port, Host=host,
                                               Origin="http://" + host)
                self.assertEqual(status, 421, (host, method, path))
                self.assertIn(b"bad_host", body)
        for path in ("agent", "view"):
            with self.assertRaises(Rejected) as rejected:
                WebSocket(self.port, f"/v1/sessions/block/{path}", f"kerf.{path}.v1",
                          ["Origin: http://evil.example"], host="evil.example")
            self.assertEqual(rejected.exception.status, 421)
        self.assertEqual(self.server.info()["motions"], 0)

    def test_addresses_and_allowed_names_are_accepted(self):
        for host in ("127.0.0.1", "localhost:1", "[::1]", "workshop", "WORKSHOP:8080",
                     "kerf.example"):
            self.assertEqual(self.request("GET", "/v1/sessions", Host=host)[0], 200, host)
        self.assertEqual(self.request("GET", "/v1/sessions", self.port, Host="workshop")[0], 421)
        own = socket.gethostname()
        for host in (own, f"{own}.local:{self.port}"):
            self.assertEqual(self.request("GET", "/v1/sessions", self.port, Host=host)[0], 200, host)

    def test_pages_of_an_allowed_origin_may_read_and_change(self):
        origin = "https://kerf.example"
        status, headers, _ = self.request("GET", "/v1/sessions", Origin=origin)
        self.assertEqual((status, headers["access-control-allow-origin"]), (200, origin))
        status, headers, _ = self.request("OPTIONS", "/v1/sessions", Origin=origin,
                                          Access_Control_Request_Method="POST")
        self.assertEqual(status, 204)
        self.assertEqual(headers["access-control-allow-origin"], origin)
        self.assertIn("POST", headers["access-control-allow-methods"])
        self.assertEqual(self.request("DELETE", "/v1/sessions/block", Origin=origin)[0], 200)

    def test_pages_of_other_origins_may_not(self):
        origin = "https://evil.example"
        status, headers, _ = self.request("GET", "/v1/sessions", Origin=origin)
        self.assertEqual(status, 200)
        self.assertNotIn("access-control-allow-origin", headers)
        status, headers, body = self.request("OPTIONS", "/v1/sessions", Origin=origin,
                                             Access_Control_Request_Method="POST")
        self.assertEqual(status, 403, body)
        self.assertNotIn("access-control-allow-methods", headers)
        self.assertEqual(self.request("DELETE", "/v1/sessions/block", Origin=origin)[0], 403)

    def test_every_response_restricts_what_a_browser_does_with_it(self):
        for path in ("/", "/v1/sessions", "/v1/sessions/block/model.stl", "/nothing", "/healthz"):
            _, headers, _ = self.request("GET", path)
            self.assertEqual(headers["x-content-type-options"], "nosniff", path)
            self.assertEqual(headers["referrer-policy"], "no-referrer", path)
            self.assertIn("frame-ancestors 'none'", headers["content-security-policy"], path)
        _, headers, _ = self.request("GET", "/")
        self.assertIn("script-src 'self'", headers["content-security-policy"])


if __name__ == "__main__":
    run_tests()
