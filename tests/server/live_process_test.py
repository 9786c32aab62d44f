# SPDX-License-Identifier: Apache-2.0
"""The process of a real server: its folder, its options, its signals, its commands and its neighbours."""
import json
import os
import resource
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from hands import bearer, carve, spiral  # noqa: E402
from kept_logs import run_tests  # noqa: E402
from live_server import PROGRAM, SCENE, LiveTest, Server, until  # noqa: E402
from nats_server import free_port  # noqa: E402
from waiting import eventually  # noqa: E402
from wire_client import Agent, Closed, Http, Viewer  # noqa: E402

AGENT, CARVE = os.environ["KERF_AGENT"], os.environ["KERF_CARVE"]


def run(*words, **more):
    done = subprocess.run([PROGRAM, *words], capture_output=True, text=True, timeout=60, **more)
    return done.returncode, done.stdout + done.stderr


class Process(LiveTest):
    def restart(self, how=signal.SIGTERM, *options):
        """Stops the server and starts it again; returns its exit status and its log."""
        ended = self.server.stop(how)
        self.server = Server(self.folder.name, *options)
        self.port = self.server.port
        return ended

    def write(self, name, text):
        path = os.path.join(self.folder.name, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text if isinstance(text, str) else json.dumps(text))
        return path

    def test_second_server_on_one_folder_exits_and_names_the_first(self):
        status, text = run("--listen", "127.0.0.1:0", "--data", self.folder.name)
        self.assertEqual(status, 1)
        self.assertIn(f"process {self.server.process.pid}", text)
        carve(Agent(self.port, "block"), 3)
        expected = self.server.hash()
        until(self, lambda: self.server.info()["journal_lag"], 0)
        # A killed server leaves its lock file, but not its lock.
        self.server.stop(signal.SIGKILL)
        self.assertTrue(os.path.exists(os.path.join(self.folder.name, "kerf-server.lock")))
        self.server = Server(self.folder.name)
        self.assertEqual(self.server.hash(), expected)

    def test_killed_server_restarts_with_the_same_hash(self):
        agent = Agent(self.port, "block")
        carve(agent, 300)
        before = self.server.info()
        until(self, lambda: self.server.info()["journal_lag"], 0)
        self.assertEqual(self.restart(signal.SIGKILL)[0], -signal.SIGKILL)
        after = self.server.info()
        for figure in ("state_hash", "motions"):
            self.assertEqual(after[figure], before[figure])
        self.assertEqual(after["epoch"], before["epoch"] + 1)
        ada = Agent(self.port, "block")
        self.assertGreater(ada.participant, agent.participant)
        for i in range(200):  # the answers are not read
            ada.move([(i * 0.05, i * 0.01, -2)])
        self.restart(signal.SIGKILL)
        self.assertGreaterEqual(self.server.info()["motions"], before["motions"])
        self.assertLessEqual(self.server.info()["motions"], before["motions"] + 200)
        carve(Agent(self.port, "block"), 50)

    def test_terminated_server_sends_bye_and_loses_nothing(self):
        agent, viewer = Agent(self.port, "block"), Viewer(self.port, "block")
        carve(agent, 100)
        before = self.server.hash()
        code, log = self.restart()
        self.assertEqual(code, 0, log)
        for peer in (agent, viewer):
            self.assertIn("shutting down", peer.receive_json("bye")["reason"])
            with self.assertRaises(Closed):
                peer.receive(5)
        self.assertEqual(self.server.hash(), before)

    def test_scenes_come_from_options_of_a_file_the_environment_and_the_command_line(self):
        carve(Agent(self.port, "block"), 50)
        self.server.stop()
        journal = os.path.join(self.folder.name, "block.kerf")
        with sqlite3.connect(journal) as database:
            database.execute("UPDATE batches SET bytes = zeroblob(7) "
                             "WHERE first = (SELECT max(first) FROM batches)")
        database.close()
        with open(journal, "rb") as file:
            damaged = file.read()
        scenes = [self.write(f"{name}.json", dict(SCENE, name=name)) for name in ("one", "two")]
        again = self.write("again.json", SCENE)  # the session whose journal cannot be read
        config = self.write("kerf.toml", f'scene = ["{scenes[0]}", "{again}"]\nudp = "off"\n')
        self.server = Server(self.folder.name, "--config", config)
        carve(Agent(self.server.port, "one"), 50)
        expected = self.server.hash("one")
        code, log = self.server.stop()
        self.assertEqual(code, 0, log)
        self.assertIn("session block of " + again + " is not open, its journal stays as it is", log)
        self.assertNotIn("UDP: port", log)
        with open(journal, "rb") as file:
            self.assertEqual(file.read(), damaged)
        # An existing session is not created again.
        self.server = Server(self.folder.name, "--scene", scenes[1], environment={
            "KERF_SCENE": scenes[0], "KERF_LOG_FORMAT": "json"})
        self.assertEqual(self.server.hash("one"), expected)
        log = self.server.stop()[1]
        messages = [json.loads(line)["message"] for line in log.splitlines()]
        self.assertIn("shutting down", messages)
        for name in ("one", "two"):
            self.assertTrue(any(m.startswith(f"session {name}: http") for m in messages), log)

    def test_streams_that_are_closed_a_low_limit_of_files_and_a_reload_do_no_harm(self):
        with tempfile.TemporaryDirectory() as folder:
            port = free_port()
            before = resource.getrlimit(resource.RLIMIT_NOFILE)
            resource.setrlimit(resource.RLIMIT_NOFILE, (min(256, before[1]), before[1]))
            try:
                shell = subprocess.Popen(
                    ["sh", "-c", 'exec "$0" --listen "$1" --data "$2" <&- >&- 2>&-', PROGRAM,
                     f"127.0.0.1:{port}", folder])
            finally:
                resource.setrlimit(resource.RLIMIT_NOFILE, before)

            def is_ready():
                self.assertIsNone(shell.poll())
                try:
                    return Http(port).request("GET", "/readyz")[0] == 200
                except OSError:
                    return False

            eventually(is_ready, "the server does not answer")
            streams = [os.readlink(f"/proc/{shell.pid}/fd/{n}") for n in range(3)]
            soft, hard = resource.prlimit(shell.pid, resource.RLIMIT_NOFILE)
            shell.send_signal(signal.SIGTERM)
            self.assertEqual(shell.wait(30), 0)
            self.assertEqual(streams, ["/dev/null"] * 3)
            self.assertEqual(soft, hard)
        # This server has no certificate.
        self.server.process.send_signal(signal.SIGHUP)
        self.assertIn("SIGHUP: nothing is changed", self.server.log_line("SIGHUP"))
        self.assertEqual(self.server.http.request("GET", "/healthz")[0], 200)

    def test_a_backup_of_a_running_server_is_checked_replayed_and_served(self):
        carve(Agent(self.port, "block"), 300)
        expected = self.server.hash()
        until(self, lambda: self.server.info()["journal_lag"], 0)
        to = os.path.join(self.folder.name, "copies")
        copy = os.path.join(to, "block.kerf")
        self.assertEqual(run("backup", self.folder.name, to), (0, copy + "\n"))
        self.assertEqual(run("check", self.folder.name)[0], 0)  # also while the server runs
        carve(Agent(self.port, "block"), 50, phase=1.0)  # the server continues
        status, text = run("check", to)
        self.assertEqual(status, 0, text)
        status, text = run("replay", copy)
        self.assertEqual(status, 0, text)
        self.assertIn("hash " + expected, text)
        other = Server(to)
        self.addCleanup(other.stop)
        self.assertEqual(other.hash(), expected)
        self.assertEqual(run("backup", self.folder.name, to)[0], 1)  # no file is replaced
        out = os.path.join(self.folder.name, "out")
        self.assertEqual(run("salvage", copy, out)[0], 0)
        for folder, _, files in os.walk(self.folder.name):  # private to their user
            for name in files:
                self.assertEqual(os.stat(os.path.join(folder, name)).st_mode & 0o077, 0, name)

    def test_copies_on_a_medium_that_cannot_be_written_are_read(self):
        carve(Agent(self.port, "block"), 50)
        self.server.stop()
        mount = 'mount --bind "$1" "$1" && mount -o remount,bind,ro "$1" && exec "$0" "$2" "$3" $4'
        other = tempfile.TemporaryDirectory()
        self.addCleanup(other.cleanup)
        odd = os.path.join(other.name, "100% of #1?")
        shutil.copytree(self.folder.name, odd)
        for words in (("check", odd), ("replay", os.path.join(odd, "block.kerf")),
                      ("backup", odd, os.path.join(other.name, "to"))):
            done = subprocess.run(["unshare", "--user", "--map-root-user", "--mount", "sh", "-c", mount,
                                   PROGRAM, odd, *words], capture_output=True, text=True, timeout=60)
            if "unshare" in done.stderr:
                self.skipTest("this machine permits no mounts of one's own: " + done.stderr)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(run("check", os.path.join(other.name, "to"))[0], 0)

    def test_kerf_carve_carves_the_exports_and_derives_the_same_scene(self):
        ada = Agent(self.port, "block")
        carve(ada, 300)
        for _ in range(2):  # programs of two tools
            status, program = self.server.http.json(
                "POST", "/v1/sessions/block/programs?pace=fast&name=s.ngc", spiral(60))
            self.assertEqual(status, 202, program)
            until(self, lambda url=program["url"]: self.server.http.json("GET", url)[1]["state"],
                  "finished")
        scene, report = self.write("scene.json", SCENE), os.path.join(self.folder.name, "report")
        for name in ("program.ngc", "program.apt"):
            text = self.server.http.request("GET", "/v1/sessions/block/" + name)[2].decode()
            done = subprocess.run([CARVE, self.write(name, text), "--scene", scene, "--report", report],
                                  capture_output=True, text=True, timeout=120)
            self.assertEqual(done.returncode, 0, done.stderr)
            with open(report, encoding="utf-8") as file:
                self.assertIn(f'"{self.server.hash()}"', file.read(), name)
        apt = "PARTNO A\nUNITS/MM\nCUTTER/8\nLOADTL/1\nFEDRAT/500\nGOTO/0,0,-2\nGOTO/30,0,-2\nFINI\n"
        ball = "(T3 - 4MM BALL ENDMILL)\nG20 G90\nT3 M6\nG1 X1 Z-.1 F20\nM30\n"
        for name, text in (("spiral.ngc", spiral(20)), ("part.apt", apt), ("ball.nc", ball)):
            status, body = self.server.http.json("POST", f"/v1/programs?name={name}", text)
            self.assertEqual(status, 200, body)
            printed = subprocess.run([CARVE, "--derive", "--program", self.write(name, text)],
                                     capture_output=True, text=True, check=True).stdout
            self.assertEqual(json.loads(printed), body, name)
            self.server.create(name.replace(".", "-"), body["scene"])

    def test_the_agent_takes_its_token_from_a_file_or_the_environment(self):
        admin = os.path.join(self.folder.name, "admin")
        self.restart(signal.SIGTERM, "--admin-token-file", admin)
        with open(admin, encoding="ascii") as file:
            token = file.read().strip()
        status, body = self.server.http.json(
            "POST", "/v1/sessions/block/invitations?role=sculptor", headers=bearer(token))
        self.assertEqual(status, 201, body)
        link = "https://kerf.example" + body["link"]
        file = self.write("link", link + "\n")
        command = [AGENT, "--server", f"http://127.0.0.1:{self.port}", "--session", "block",
                   "--device", "sim", "--duration", "0.2", "--patience", "5"]
        plain = {key: value for key, value in os.environ.items() if key != "KERF_TOKEN"}
        for more, environment, is_good in ((["--token-file", file], plain, True),
                                           ([], dict(plain, KERF_TOKEN=link.split("=")[-1]), True),
                                           ([], plain, False)):
            done = subprocess.run([*command, *more], env=environment, capture_output=True, text=True,
                                  timeout=60, check=False)
            self.assertEqual(done.returncode == 0, is_good, done.stderr)
        self.assertIn("needs a token", done.stderr)
        log = self.server.stop()[1]
        self.assertNotIn(token, log)
        self.assertNotIn("kerf_", log)


if __name__ == "__main__":
    run_tests()
