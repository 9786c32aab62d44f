# SPDX-License-Identifier: Apache-2.0
"""Measures the waits of one user while two others send the most expensive permitted requests.

KERF_SERVER=build/release/bin/kerf-server python3 tests/bench/turns_bench.py

A guest requests simplified models on six connections, and a sculptor sends an endless program on
eight. Meanwhile an owner undoes and redoes a stroke, sets and removes a pin, lists strokes,
creates and closes a session. Prints the median, the 99th percentile and the greatest wait of each
in s, then the time from SIGTERM to the end of the server.
"""
import argparse
import http.client
import itertools
import json
import os
import signal
import sys
import tempfile
import threading
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "server"))

from live_server import SCENE, Server  # noqa: E402

FINE = dict(SCENE, accuracy={"rays": "tri-dexel", "pitch_mm": 0.25, "tolerance_mm": 0.01,
                             "motion": "tight"})
ENDLESS = "O1\nT1 M6\n#1=0\nWHILE[1EQ1]DO1\n#1=#1+1\nEND1\nM30\n"


def bowls(count):
    """A program of bowls, whose surface takes long to simplify."""
    lines = ["G21 G90", "T1 M6", "F3000", "G0 X0 Y0 Z5"]
    for n in range(count):
        x, y = n % 8 * 5 - 17, n // 8 % 8 * 5 - 17
        lines += [f"G0 X{x} Y{y} Z2", f"G1 Z{-1 - n % 5}", f"X{x + 3} Y{y + 2}", "G0 Z5"]
    return "\n".join(lines + ["M2", ""])


class Bench:
    def __init__(self, folder):
        admin = os.path.join(folder, "admin")
        self.server = Server(os.path.join(folder, "data"), "--admin-token-file", admin, "--open")
        with open(admin, encoding="ascii") as file:
            self.admin = file.read().strip()
        self.must("POST", "/v1/sessions?id=fine", self.admin, SCENE_TEXT)
        self.must("POST", "/v1/sessions?id=other", self.admin, SCENE_TEXT)
        for session in ("fine", "other"):
            program = self.must("POST", f"/v1/sessions/{session}/programs", self.admin, bowls(64))
            while self.must("GET", program["url"], self.admin)["state"] != "finished":
                time.sleep(0.1)
        self.sculptor = self.invited("fine", "sculptor")
        self.stop = threading.Event()
        self.waits = {}

    def ask(self, method, path, token=None, body=None):
        return self.server.http.json(method, path, body,
                                     {"Authorization": "Bearer " + token} if token else {})

    def must(self, method, path, token, body=None):
        status, answer = self.ask(method, path, token, body)
        assert status < 300, (path, answer)
        return answer

    def invited(self, session, role):
        invitation = self.must("POST", f"/v1/sessions/{session}/invitations?role={role}", self.admin)
        _, headers, _ = self.server.http.request(
            "POST", f"/v1/sessions/{session}/join?name=Sam", None,
            {"Authorization": "Bearer " + invitation["token"]})
        return headers["set-cookie"].split(";")[0].split("=", 1)[1]

    def attack(self, ask):
        while not self.stop.is_set():
            try:
                ask()
            except (OSError, http.client.HTTPException):
                pass  # the server ends

    def attackers(self, guests, sculptors):
        numbers = itertools.count(2000)

        def export():
            self.server.http.request(
                "GET", f"/v1/sessions/fine/model.stl?triangles={next(numbers)}")

        def program():
            self.ask("POST", "/v1/sessions/fine/programs?dialect=fanuc", self.sculptor, ENDLESS)

        asks = [export] * guests + [program] * sculptors
        return [threading.Thread(target=self.attack, args=(ask,), daemon=True) for ask in asks]

    def timed(self, what, method, path, body=None):
        begin = time.monotonic()
        try:
            return self.must(method, path, self.admin, body)
        finally:
            self.waits.setdefault(what, []).append(time.monotonic() - begin)

    def work(self, number):
        stroke = self.timed("strokes", "GET", "/v1/sessions/other/strokes")["strokes"][-1]["id"]
        self.timed("undo", "POST", f"/v1/sessions/other/undo?strokes={stroke}")
        self.timed("redo", "POST", f"/v1/sessions/other/redo?strokes={stroke}")
        pin = self.timed("pin", "POST", "/v1/sessions/other/pins?text=here&at_mm=0,0,0&normal=0,0,1")
        self.timed("pin", "DELETE", f"/v1/sessions/other/pins/{pin['pin']}")
        self.timed("create", "POST", f"/v1/sessions?id=new{number}", SCENE_TEXT)
        self.timed("close", "DELETE", f"/v1/sessions/new{number}?purge=1")

    def report(self):
        for what, waits in self.waits.items():
            waits.sort()
            p50, p99 = (waits[int(share * len(waits))] for share in (0.5, 0.99))
            print(f"{what:8} {len(waits):4} times  p50 {p50:6.3f}  p99 {p99:6.3f}  "
                  f"greatest {waits[-1]:6.3f} s", flush=True)


SCENE_TEXT = json.dumps(FINE)


def main():
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--seconds", type=float, default=20)
    options.add_argument("--guests", type=int, default=6)
    options.add_argument("--sculptors", type=int, default=8)
    options = options.parse_args()
    with tempfile.TemporaryDirectory(prefix="kerf-bench-") as folder:
        bench = Bench(folder)
        for thread in bench.attackers(options.guests, options.sculptors):
            thread.start()
        time.sleep(2)  # until all of them wait
        end = time.monotonic() + options.seconds
        try:
            for number in itertools.count():
                bench.work(number)
                if time.monotonic() > end:
                    break
        except TimeoutError:
            print("the last one had no answer when its connection timed out")
        bench.report()
        bench.stop.set()
        begin = time.monotonic()
        bench.server.process.send_signal(signal.SIGTERM)
        bench.server.process.communicate()
        print(f"SIGTERM  {time.monotonic() - begin:.2f} s, status {bench.server.process.returncode}")


if __name__ == "__main__":
    main()
