# SPDX-License-Identifier: Apache-2.0
"""The process of a real server: its data folder, its limits, and requests without one Host."""
import json
import os
import re
import resource
import signal
import socket
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from kept_logs import run_tests  # noqa: E402
from live_server import PROGRAM, SCENE, LiveTest, Server, until  # noqa: E402
from nats_server import free_port  # noqa: E402
from waiting import eventually  # noqa: E402
from wire_client import ACK, Agent, Http, Viewer, header, motion_frame, sample  # noqa: E402


class Folder(LiveTest):
    def test_second_server_on_one_folder_exits_and_names_the_first(self):
        agent = Agent(self.port, "block")
        second = subprocess.run([PROGRAM, "--listen", "127.0.0.1:0", "--data", self.folder.name],
                                capture_output=True, text=True, timeout=30)
        self.assertEqual(second.returncode, 1)
        self.assertEqual(second.stdout, "")
        self.assertIn(f"process {self.server.process.pid}", second.stderr)
        agent.move([(0, 0, -1)])
        agent.move([(1, 0, -1)])
        agent.result()
        expected = self.server.hash()
        until(self, lambda: self.server.info()["journal_lag"], 0)
        # A killed server leaves its lock file, but not its lock.
        self.server.stop(signal.SIGKILL)
        self.assertTrue(os.path.exists(os.path.join(self.folder.name, "kerf-server.lock")))
        self.server = Server(self.folder.name)
        self.assertEqual(self.server.hash(), expected)

    def test_limit_of_open_files_is_raised(self):
        self.server.stop()
        before = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (min(256, before[1]), before[1]))
        try:
            self.server = Server(self.folder.name)
        finally:
            resource.setrlimit(resource.RLIMIT_NOFILE, before)
        soft, hard = resource.prlimit(self.server.process.pid, resource.RLIMIT_NOFILE)
        self.assertEqual(soft, hard)
        self.assertGreater(hard, 256)


class End(LiveTest):
    def test_a_server_ends_without_viewers_that_do_not_answer(self):
        """A sanitizer saw connections use a thread that had been destroyed."""
        viewers = [Viewer(self.port, "block", name) for name in ("Ada", "Bo", "Cy")]
        agent = Agent(self.port, "block")
        for step in range(50):
            agent.move([(step * 0.1, 0, -1)])
        status, log = self.server.stop()
        self.assertEqual(status, 0, log)
        self.assertEqual(len(viewers), 3)  # their sockets were open until now


class Configuration(LiveTest):
    """Options from the command line, a file and the environment."""

    def run_server(self, *options, text=None, **environment):
        """Starts a server that a signal ends; returns its address, exit code and log."""
        with tempfile.TemporaryDirectory() as folder:
            if text is not None:
                path = os.path.join(folder, "kerf.toml")
                with open(path, "w", encoding="utf-8") as file:
                    file.write(text)
                options += ("--config", path)
            process = subprocess.Popen(
                [PROGRAM, *options], env={**os.environ, "KERF_DATA": folder, **environment},
                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            address = process.stdout.readline().strip()
            if address:
                process.send_signal(signal.SIGTERM)
            _, log = process.communicate(timeout=30)
            return address, process.returncode, log

    def test_a_service_without_a_certificate_survives_a_reload(self):
        with tempfile.TemporaryDirectory() as folder:
            server = Server(folder)
            server.process.send_signal(signal.SIGHUP)
            self.assertIn("SIGHUP: nothing is changed", server.log_line("SIGHUP"))
            self.assertEqual(server.http.request("GET", "/healthz")[0], 200)
            status, _ = server.stop()
            self.assertEqual(status, 0)

    def test_options_may_stand_in_a_file_and_in_the_environment(self):
        address, code, log = self.run_server(
            text='listen = "127.0.0.2:0"\nlog-format = "json"\nallow-host = ["a.example"]\n')
        self.assertTrue(address.startswith("http://127.0.0.2:"), address)
        self.assertEqual(code, 0)
        messages = [json.loads(line)["message"] for line in log.splitlines()]
        self.assertIn("shutting down", messages)
        address, code, _ = self.run_server(KERF_LISTEN="127.0.0.3:0")
        self.assertTrue(address.startswith("http://127.0.0.3:"), address)

    def test_a_server_on_all_addresses_prints_one_that_can_be_opened(self):
        for every in ("0.0.0.0:0", "[::]:0"):
            address, code, _ = self.run_server("--listen", every, "--open", "--udp", "off")
            self.assertTrue(address.startswith("http://localhost:"), address)
            self.assertEqual(code, 0)

    def test_the_command_line_counts_before_the_file_and_the_file_before_the_environment(self):
        text = 'listen = "127.0.0.2:0"\n'
        address, _, _ = self.run_server(text=text, KERF_LISTEN="127.0.0.3:0")
        self.assertTrue(address.startswith("http://127.0.0.2:"), address)
        address, _, _ = self.run_server("--listen", "127.0.0.4:0", text=text)
        self.assertTrue(address.startswith("http://127.0.0.4:"), address)

    def test_a_list_in_the_environment_is_separated_by_commas_or_spaces(self):
        scenes = []
        with tempfile.TemporaryDirectory() as folder:
            for name in ("one", "two", "three"):
                scenes.append(os.path.join(folder, name + ".json"))
                with open(scenes[-1], "w", encoding="utf-8") as file:
                    json.dump(dict(SCENE, name=name), file)
            listen = {"KERF_LISTEN": "127.0.0.1:0"}
            lists = {"KERF_SCENE": f"{scenes[0]}, {scenes[1]}  {scenes[2]}"}
            _, code, log = self.run_server(**listen, **lists)
            self.assertEqual(code, 0, log)
            for name in ("one", "two", "three"):
                self.assertIn(f"session {name}: ", log)
            # The command line counts before it.
            _, code, log = self.run_server("--scene", scenes[0], **listen, **lists)
            self.assertIn("session one: ", log)
            self.assertNotIn("session two: ", log)

    def test_options_that_would_have_no_effect_or_another_one_are_errors(self):
        for options in (("--allow-origin", "kerf.example"), ("--allow-origin", "https://kerf.example/"),
                        ("--allow-origin", "null"), ("--allow-host", "https://kerf.example"),
                        ("--allow-host", "a b"), ("--disk-reserve", "nan"), ("--disk-total", "-1"),
                        ("--snapshot-after", "inf"), ("--viewer-budget", "24"),
                        ("--viewer-budget", "nan"), ("--web", "/does/not/exist")):
            with self.subTest(options):
                address, code, log = self.run_server("--listen", "127.0.0.1:0", *options)
                self.assertEqual(address, "")
                self.assertNotEqual(code, 0)
                self.assertIn(options[0], log)
                self.assertIn(options[1], log)
        for options in (("--allow-host", "kerf.example"), ("--allow-host", "kerf.example:8443"),
                        ("--allow-origin", "https://kerf.example:8443"), ("--disk-reserve", "1e3"),
                        ("--viewer-budget", "0"), ("--viewer-budget", "62.5")):
            with self.subTest(options):
                self.assertEqual(self.run_server("--listen", "127.0.0.1:0", *options)[1], 0)

    def test_without_standard_streams_nothing_is_written_into_other_files(self):
        with tempfile.TemporaryDirectory() as folder:
            port = free_port()
            shell = subprocess.Popen(
                ["sh", "-c", 'exec "$0" --listen "$1" --data "$2" <&- >&- 2>&-', PROGRAM,
                 f"127.0.0.1:{port}", folder])

            def is_ready():
                self.assertIsNone(shell.poll())
                try:
                    return Http(port).request("GET", "/readyz")[0] == 200
                except OSError:
                    return False

            eventually(is_ready, "the server does not answer")
            streams = [os.readlink(f"/proc/{shell.pid}/fd/{n}") for n in range(3)]
            shell.send_signal(signal.SIGTERM)
            self.assertEqual(shell.wait(30), 0)
            self.assertEqual(streams, ["/dev/null"] * 3)

    def test_an_unknown_key_of_the_file_is_an_error_that_names_it(self):
        address, code, log = self.run_server(text='lisen = "127.0.0.2:0"\n')
        self.assertEqual((address, code), ("", 2))
        self.assertIn("--config: there is no option 'lisen'", log)

    def test_each_value_of_the_file_has_the_type_of_its_option(self):
        for line, why in (('open = "yes"', "open must be true or false, without quotes"),
                          ("open = 1", "open must be true or false"),
                          ("open", "open has no value"),
                          ('disk-total = "5"', "disk-total must be a number, without quotes"),
                          ("disk-total = true", "disk-total must be a number"),
                          ("log-format = json", "log-format must be a text in quotes"),
                          ("udp = 9000", "udp must be a text in quotes"),
                          ("allow-host = true", "allow-host must be a list of texts in quotes"),
                          ("allow-host = [1, 2]", "allow-host must be a list of texts"),
                          ('allow-host = ["a"', "allow-host has a list that is not closed"),
                          ('log-format = "json', "log-format has quotes that are not closed")):
            with self.subTest(line):
                address, code, log = self.run_server(text='listen = "127.0.0.1:0"\n# one\n' + line + "\n")
                self.assertEqual((address, code), ("", 2), log)
                self.assertRegex(log, r"^kerf-server: --config: .*kerf\.toml:3: " + re.escape(why))
                self.assertRegex(log, r"--help lists the options\n$")
        text = ('listen = "127.0.0.1:0" # one\nopen = true\ndisk-total = 5.5\nlog-format = \'json\'\n'
                'allow-host = ["a.example",\n  "b.example"]\nallow-origin = "https://c.example"\n'
                "viewer-budget = 500\nlease-ms = 5000\n")
        address, code, log = self.run_server(text=text)
        self.assertEqual(code, 0, log)

    def test_an_unknown_option_exits_with_2_and_says_what_to_do(self):
        for options in (("--lisen", "127.0.0.2:0"), ("--disk-total", "many")):
            address, code, log = self.run_server(*options)
            self.assertEqual((address, code), ("", 2))
            self.assertRegex(log, r"^kerf-server: .*--help lists the options\n$")


class Metrics(LiveTest):
    """Served, listed in the README and shown by the dashboard are the same metrics."""
    NAME = re.compile(r"\bkerf_[a-z_]+")

    def read(self, *path):
        top = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
        with open(os.path.join(top, *path), encoding="utf-8") as file:
            return file.read()

    def served(self):
        agent = Agent(self.port, "block")
        agent.move([(0, 0, -1)])
        agent.move([(1, 0, -1)])
        agent.result()
        text = self.server.http.request("GET", "/metrics")[2].decode()
        return set(re.findall(r"^# TYPE (\S+)", text, re.MULTILINE))

    def test_readme_lists_every_metric(self):
        rows = [row for row in self.read("server", "metrics", "README.md").splitlines()
                if row.startswith("| `")]
        listed = {name for row in rows for name in self.NAME.findall(row.split("|")[1])}
        # Counted by label, so it appears with the first one; those of --nats (live_copy_test); and that
        # of TLS (live_tls_test).
        others = {"kerf_refused_total", "kerf_copied_record", "kerf_copy_lag_records",
                  "kerf_copied_snapshot_record", "kerf_certificate_days_left"}
        self.assertEqual(listed, self.served() | others)

    def test_dashboard_shows_metrics_that_exist(self):
        dashboard = json.loads(self.read("docker", "grafana.json"))
        expressions = [target["expr"] for panel in dashboard["panels"]
                       for target in panel["targets"]]
        self.assertGreater(len(expressions), 12)
        served = self.served() | {"kerf_refused_total"}
        for expression in expressions:
            for name in self.NAME.findall(expression):
                self.assertIn(name.removesuffix("_bucket"), served, expression)


class Hosts(LiveTest):
    def ask(self, *lines):
        with socket.create_connection(("127.0.0.1", self.port), timeout=10) as raw:
            raw.sendall(("\r\n".join(lines) + "\r\n\r\n").encode())
            answer = b""
            while data := raw.recv(65536):
                answer += data
                if b"\r\n\r\n" in answer and b"}" in answer:
                    break
        status = int(answer.split()[1])
        code = re.search(rb'"code":"([a-z_]+)"', answer)
        return status, code and code.group(1).decode()

    def test_requests_need_one_host(self):
        upgrade = ("Upgrade: websocket", "Connection: Upgrade", "Sec-WebSocket-Version: 13",
                   "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
                   "Sec-WebSocket-Protocol: kerf.agent.v1")
        for line, more in (("GET /healthz HTTP/1.1", ()),
                           ("DELETE /v1/sessions/block HTTP/1.1", ()),
                           ("GET /v1/sessions/block/agent HTTP/1.1", upgrade)):
            self.assertEqual(self.ask(line, *more), (400, "bad_host"), line)
            self.assertEqual(self.ask(line, "Host: localhost", "Host: b", *more), (400, "bad_host"), line)
            self.assertEqual(self.ask(line, "Host: localhost", "Host: localhost", *more), (400, "bad_host"), line)
        self.assertEqual(self.ask("GET /healthz HTTP/1.1", "Host: localhost"), (200, None))
        self.assertEqual(self.ask("GET /healthz HTTP/1.0"), (200, None))
        self.assertEqual(self.server.info()["id"], "block")


class Epochs(LiveTest):
    def test_frames_of_an_earlier_epoch_have_no_effect(self):
        first = Agent(self.port, "block")
        self.server.stop()
        self.server = Server(self.folder.name)
        agent = Agent(self.server.port, "block")
        self.assertEqual(agent.epoch, first.epoch + 1)
        agent.send_binary(motion_frame([sample(1, 1000, (0, 0, -1)), sample(2, 2000, (1, 0, -1))],
                                       first.epoch))
        self.assertEqual(agent.receive_json("error")["code"], "bad_epoch")
        self.assertEqual(self.server.info()["motions"], 0)
        agent.move([(0, 0, -1), (1, 0, -1)])
        self.assertGreater(agent.result()["removed"], 0)
        viewer = Viewer(self.server.port, "block")
        viewer.settled()
        viewer.send_binary(header(ACK, 0, sequence=1, epoch=first.epoch))
        self.assertEqual(viewer.receive_json("error")["code"], "bad_epoch")


if __name__ == "__main__":
    run_tests()
