# SPDX-License-Identifier: Apache-2.0
"""Tests a real server with agents, programs and viewers; restarts; downloads."""
import glob
import json
import math
import os
import shutil
import signal
import sqlite3
import tempfile
import threading
import time

from kept_logs import run_tests
from live_server import SCENE, LiveTest, Server, until
from waiting import eventually
from wire_client import Agent, Closed, Http, Viewer

PROGRAM = """%
G21 G90 G17 G94
T2 M6
G0 X-15 Y-15 Z5
G1 Z-3 F600
X15 F1200
Y15
G3 X-15 Y15 I-15 J0
G1 Z5
M2
%
"""


def carve(agent, steps=400, phase=0.0):
    """Cuts along a spiral; returns the removed volume that the results reported."""
    removed, sent = 0.0, 0
    for i in range(steps):
        angle = phase + i * 0.02
        radius = 4 + 8 * i / steps
        agent.move([(radius * math.cos(angle), radius * math.sin(angle), -2 - i / steps)])
        sent += 1
        result = agent.result()
        removed += result["removed"]
    return removed


def finish(server, program, session="block", timeout=60):
    def ended():
        status = server.http.json("GET", f"/v1/sessions/{session}/programs/{program}")[1]
        return status if status["state"] != "running" else None

    return eventually(ended, "the program does not end", timeout)


def upload(server, text, query, session="block"):
    status, body = server.http.json("POST", f"/v1/sessions/{session}/programs?{query}", text)
    assert status == 202, body
    return body


class Carving(LiveTest):
    def test_results_carry_force_and_removed_volume(self):
        agent = Agent(self.port, "block")
        agent.move([(-30, 0, -2)])
        removed = 0.0
        force = 0.0
        for i in range(300):
            agent.move([(-30 + 0.1 * i, 0, -2)])
            result = agent.result()
            removed += result["removed"]
            force = max(force, -result["fx"])
        self.assertAlmostEqual(removed, self.server.info()["removed_volume_mm3"], delta=removed * 1e-5)
        self.assertGreater(removed, 50)
        self.assertGreater(force, 0.5)
        self.assertGreater(result["area"], 1)
        self.assertEqual(result["status"] & 1, 1)

    def test_session_threads_are_not_nice(self):
        """The thread of a session created by an upload has the same priority as that of a scene option."""
        def niceness(task):
            with open(f"{task}/stat") as stat:
                return int(stat.read().rpartition(")")[2].split()[16])

        tasks = [f"/proc/{self.server.process.pid}/task/{task}"
                 for task in os.listdir(f"/proc/{self.server.process.pid}/task")]
        threads = {}
        for task in tasks:
            with open(f"{task}/comm") as comm:
                threads.setdefault(comm.read().strip(), niceness(task))
        own = os.getpriority(os.PRIO_PROCESS, 0)
        self.assertEqual(threads["s:block"], own)
        self.assertGreater(threads["workers"], own)

    def test_air_moves_cut_nothing(self):
        agent = Agent(self.port, "block")
        for i in range(10):
            agent.move([(-10 + i, 0, -2)], buttons=0)
            agent.result()
        info = self.server.info()
        self.assertEqual((info["motions"], info["removed_volume_mm3"]), (0, 0))

    def test_gap_between_samples_sweeps_the_chord(self):
        one, two = Agent(self.port, "block"), Agent(self.port, "block")
        one.move([(-10, 0, -2)])
        one.result()
        one.sequence += 50  # fifty samples were lost
        one.move([(10, 0, -2)], step_us=50_000)
        self.assertGreater(one.result()["removed"], 100)
        two.move([(0, 0, -2)])
        two.move([(1, 0, -2)])
        self.assertEqual(two.result()["removed"], 0)

    def test_batch_is_answered_by_one_result(self):
        agent = Agent(self.port, "block")
        agent.move([(0.1 * i, 0, -2) for i in range(16)])
        result = agent.result(16)
        self.assertEqual(result["motions"], 15)
        removed = self.server.info()["removed_volume_mm3"]
        self.assertAlmostEqual(result["removed"], removed, delta=1e-3)

    def test_two_agents_and_a_program_at_once(self):
        agents = [Agent(self.port, "block", name) for name in ("Ada", "Grace")]
        viewer = Viewer(self.port, "block")
        program = upload(self.server, PROGRAM, "pace=fast&name=frame.ngc")
        removed = [0.0, 0.0]

        def work(n):
            removed[n] = carve(agents[n], 300, n * math.pi)

        threads = [threading.Thread(target=work, args=(n,)) for n in (0, 1)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        status = finish(self.server, program["id"])
        self.assertEqual((status["state"], status["progress"]), ("finished", 1.0))
        info = self.server.info()
        total = sum(removed) + status["removed_volume_mm3"]
        self.assertAlmostEqual(info["removed_volume_mm3"], total, delta=total * 1e-4)
        self.assertGreater(min(removed), 1)
        state = viewer.settled()
        while state["state_hash"] != self.server.hash():
            state = viewer.settled()
        self.assertEqual(state["motions"], info["motions"])

    def test_agents_are_answered_while_a_program_runs(self):
        agent = Agent(self.port, "block")
        lines = ["G21 G90 T2 M6", "G0 X0 Y0 Z-1"]
        lines += [f"G1 X{15 if i % 2 else -15} Y{(i % 300) / 10 - 15:.1f} F3000"
                  for i in range(20000)]
        program = upload(self.server, "\n".join(lines + ["M2"]), "pace=fast&name=long.ngc")
        carve(agent, 50)
        status = self.server.http.json("GET", program["url"])[1]
        self.assertEqual(status["state"], "running")
        status, body = self.server.http.json("DELETE", program["url"])
        self.assertEqual((status, body["state"]), (200, "cancelled"))
        self.assertEqual(self.server.http.json("DELETE", program["url"])[0], 409)
        kinds = [who["kind"] for who in self.server.info()["participants"]]
        self.assertEqual(kinds, ["agent"])

    def test_program_at_feed_rate_runs_in_real_time(self):
        start = time.monotonic()  # the program runs before its upload is answered
        program = upload(self.server, "G21 G90 T2 M6\nG0 X-5 Y0 Z-1\nG1 X5 F600\nM2\n",
                         "pace=feed&name=slow.ngc")
        self.assertAlmostEqual(program["programmed_s"], 1.0, delta=0.2)
        status = finish(self.server, program["id"])
        self.assertEqual(status["state"], "finished")
        self.assertGreater(time.monotonic() - start, 0.5)
        self.assertEqual(status["motions"], 1, "blocks are carved whole")

    def test_participants_are_reported_when_they_join_change_tool_and_leave(self):
        ada = Agent(self.port, "block", "Ada", color="#123456")
        viewer = Viewer(self.port, "block", "Grace")
        names = {p["name"]: p for p in viewer.welcome["participants"]}
        self.assertEqual(names["Ada"]["color"], "#123456")
        ada.send_json({"type": "tool", "tool": 2})
        people = viewer.receive_json("participants")["participants"]
        while {p["name"]: p for p in people}["Ada"]["tool"] != 2:
            people = viewer.receive_json("participants")["participants"]
        ada.move([(1, 2, 3)], tool=2)
        while not viewer.tools:
            viewer.take()
        self.assertEqual(viewer.tools[0][:5], (ada.participant, 2, 1.0, 2.0, 3.0))
        ada.close()
        people = viewer.receive_json("participants")["participants"]
        self.assertEqual([p["name"] for p in people], ["Grace"])

    def test_viewers_settle_on_the_state_hash(self):
        early = Viewer(self.port, "block")
        self.assertEqual(early.settled()["state_hash"], self.server.hash())
        tiles = len(early.tiles)
        self.assertEqual(tiles, 9)  # 80 columns a side are 3 x 3 tiles
        agent = Agent(self.port, "block")
        carve(agent, 200)
        late = Viewer(self.port, "block")
        for viewer in (early, late):
            state = viewer.settled()
            while state["state_hash"] != self.server.hash():
                state = viewer.settled()
            self.assertEqual(len(viewer.tiles), 9)
        self.assertGreater(max(early.tiles.values()), 1)

    def test_distant_viewers_get_coarse_tiles_and_near_ones_exact_tiles(self):
        carve(Agent(self.port, "block"), 200)
        near, far = Viewer(self.port, "block"), Viewer(self.port, "block", "Far")
        far.send_json({"type": "look", "eye_mm": [0, 0, 1e5], "error_rad": 0.01})
        while set(far.levels.values()) != {3} or len(far.levels) != 9:
            far.take()
        near.settled()
        self.assertEqual(set(near.levels.values()), {0})
        far.send_json({"type": "look", "eye_mm": [0, 0, 1e5], "error_rad": 0})
        while set(far.levels.values()) != {0}:
            far.take()
        for _ in range(40):
            far.send_json({"type": "look", "eye_mm": [0, 0, 1e5], "error_rad": 0})
        self.assertEqual(far.receive_json("error")["code"], "too_fast")


    def test_the_first_snapshot_starts_with_the_first_look(self):
        carve(Agent(self.port, "block"), 100)
        afar = {"eye_mm": [0, 0, 1e5], "error_rad": 0.01}
        known = Viewer(self.port, "block", look=afar)
        known.settled()
        following = Viewer(self.port, "block", "Later", look=True)
        following.send_json({"type": "look", **afar})
        following.settled()
        for viewer in known, following:
            self.assertEqual((viewer.received, set(viewer.levels.values())), (9, {3}))
        silent = Viewer(self.port, "block", "Silent", look=True)
        silent.settled()
        self.assertEqual((silent.received, set(silent.levels.values())), (9, {0}))

    def test_mesh_frames_state_the_motions_that_they_include(self):
        agent = Agent(self.port, "block")
        carve(agent, 50)
        viewer = Viewer(self.port, "block")
        state = viewer.settled()
        self.assertGreaterEqual(state["motions"], 49)
        self.assertEqual(viewer.motions, state["motions"])
        carve(agent, 50, phase=2.0)
        while viewer.motions <= state["motions"]:
            viewer.take()


class Downloads(LiveTest):
    def setUp(self):
        super().setUp()
        self.agent = Agent(self.port, "block")
        carve(self.agent, 300)
        finish(self.server, upload(self.server, PROGRAM, "pace=fast&name=a.ngc")["id"])

    def get(self, name, **headers):
        return self.server.http.request("GET", f"/v1/sessions/block/{name}", headers=headers)

    def test_etag_is_the_state_hash(self):
        status, headers, body = self.get("model.stl")
        self.assertEqual(status, 200)
        self.assertEqual(headers["etag"], f'"{self.server.hash()}"')
        self.assertEqual(len(body), int(headers["content-length"]))
        self.assertEqual((len(body) - 84) % 50, 0)
        status, _, body = self.get("model.stl", **{"If-None-Match": headers["etag"]})
        self.assertEqual((status, body), (304, b""))
        status, head, body = self.server.http.request("HEAD", "/v1/sessions/block/model.stl")
        self.assertEqual((status, body), (200, b""))
        self.assertEqual(head["content-length"], headers["content-length"])

    def test_each_format_has_its_type_magic_and_file_name(self):
        for name, kind, begin, file_name in (
                ("model.stl", "model/stl", b"Kerf STL", "block.stl"),
                ("model.stl?encoding=ascii", "model/stl", b"solid block", "block-ascii.stl"),
                ("model.glb", "model/gltf-binary", b"glTF", "block.glb"),
                ("model.glb?encoding=quantized", "model/gltf-binary", b"glTF",
                 "block-quantized.glb"),
                ("model.glb?encoding=meshopt", "model/gltf-binary", b"glTF", "block-meshopt.glb"),
                ("model.3mf", "model/3mf", b"PK", "block.3mf"),
                ("model.ply", "application/vnd.ply", b"ply", "block.ply"),
                ("model.obj", "model/obj", b"# block", "block.obj"),
                ("program.ngc", "text/plain", b"%", "block.ngc"),
                ("program.ngc?post=fanuc", "text/plain", b"%\nO1000", "block-fanuc.ngc"),
                ("journal", "application/vnd.sqlite3", b"SQLite", "block.kerf")):
            status, headers, body = self.get(name)
            self.assertEqual((status, headers["content-type"]), (200, kind), name)
            self.assertEqual(body[:len(begin)], begin)
            self.assertEqual(headers["content-disposition"],
                             f'attachment; filename="{file_name}"')
        status, headers, body = self.get("model.stl?triangles=500")
        self.assertLessEqual((len(body) - 84) // 50, 500)
        self.assertIn('"block-500-triangles.stl"', headers["content-disposition"])
        whole = self.get("model.stl")[2]
        self.assertLess(len(self.get("model.stl?error_mm=0.2")[2]), len(whole))
        self.assertEqual(self.get("model.stl?triangles=0")[0], 400)
        self.assertEqual(self.get("model.stl?error_mm=nan")[0], 400)
        status, _, body = self.get("model.stl?triangles=3")
        self.assertEqual((status, json.loads(body)["error"]["code"]), (422, "budget_impossible"))
        status, _, body = self.get("model.glb?encoding=ascii")
        self.assertEqual((status, json.loads(body)["error"]["code"]), (400, "bad_encoding"))
        self.assertEqual(self.get("model.dxf")[0], 404)
        # The scene's machine is tool-vector.
        status, _, body = self.get("program.ngc?post=heidenhain")
        self.assertEqual((status, json.loads(body)["error"]["code"]), (422, "bad_post"))

    def test_non_ascii_name_is_sent_in_both_forms(self):
        self.server.create("cup", dict(SCENE, name="Täßchen: 1/2"))
        headers = self.server.http.request("GET", "/v1/sessions/cup/model.stl")[1]
        self.assertEqual(headers["content-disposition"],
                         'attachment; filename="T__chen- 1-2.stl"; '
                         "filename*=UTF-8''T%C3%A4%C3%9Fchen-%201-2.stl")

    def test_ranges(self):
        _, headers, whole = self.get("model.stl")
        self.assertEqual(headers["accept-ranges"], "bytes")
        size, etag = len(whole), headers["etag"]
        for text, first, last in (("0-99", 0, 99), ("100-", 100, size - 1),
                                  ("-7", size - 7, size - 1), (f"5-{size + 9}", 5, size - 1)):
            status, headers, body = self.get("model.stl", Range=f"bytes={text}")
            self.assertEqual((status, body), (206, whole[first:last + 1]), text)
            self.assertEqual(headers["content-range"], f"bytes {first}-{last}/{size}")
        status, headers, body = self.get("model.stl", Range=f"bytes={size}-")
        self.assertEqual((status, headers["content-range"]), (416, f"bytes */{size}"))
        self.assertEqual(json.loads(body)["error"]["code"], "bad_range")
        ranged = {"Range": "bytes=0-9", "If-Range": etag}
        self.assertEqual(self.get("model.stl", **ranged)[0], 206)
        # After a change of the block, the rest of the old file is of no use.
        ranged["If-Range"] = '"0000000000000000"'
        self.assertEqual(self.get("model.stl", **ranged)[0::2], (200, whole))
        self.assertEqual(self.get("model.stl", Range="bytes=1-2,4-5")[0], 200)
        self.assertEqual(self.get("model.stl", Range="lines=1-2")[0], 200)
        self.assertEqual(self.get("program.apt", Range="bytes=0-6")[2], b"PARTNO/")

    def test_exports_lists_downloads_in_preparation(self):
        # The round side of a cylinder: triangles that no export merges, so the download takes long.
        rod = {"shape": "cylinder", "center_mm": [0, 0], "radius_mm": 20, "min_z_mm": -40,
               "max_z_mm": 0}
        fine = dict(SCENE, name="fine", stock=rod, accuracy={"pitch_mm": 0.05})
        self.server.create("fine", fine)
        seen = []

        def download():
            Http(self.port).request("GET", "/v1/sessions/fine/model.obj?error_mm=0")

        loader = threading.Thread(target=download)
        loader.start()
        while loader.is_alive():
            seen += self.server.http.json("GET", "/v1/sessions/fine/exports")[1]["exports"]
            loader.join(0.005)
        self.assertEqual({export["name"] for export in seen}, {"model.obj"})
        shares = [export["share"] for export in seen]
        self.assertEqual(shares, sorted(shares))
        self.assertTrue(0 < shares[-1] <= 1, shares)
        self.assertEqual(self.server.http.json("GET", "/v1/sessions/fine/exports")[1],
                         {"exports": []})

    def test_exported_programs_carve_the_same_solid(self):
        for name in ("program.ngc", "program.apt"):
            status, _, text = self.get(name)
            self.assertEqual(status, 200, text)
            session = name.replace(".", "-")
            self.server.create(session)
            run = upload(self.server, text, f"pace=fast&name={name}", session)
            status = finish(self.server, run["id"], session)
            self.assertEqual(status["state"], "finished", status)
            self.assertEqual(self.server.hash(session), self.server.hash(), name)

    def test_program_of_a_range_of_records_or_joined_within_a_tolerance(self):
        whole = self.get("program.apt")[2].count(b"GOTO/")
        part = self.get("program.apt?from=100&to=150")[2].count(b"GOTO/")
        self.assertTrue(40 <= part <= 51, part)
        status, headers, joined = self.get("program.apt?tolerance_mm=0.05")
        self.assertIn(b"strays more than 0.05 mm", joined)
        self.assertLess(joined.count(b"GOTO/"), whole * 2 // 3)
        self.assertIn('"block-0.05mm.apt"', headers["content-disposition"])
        # The swept volume changes by no more than the tolerance.
        self.server.create("joined")
        run = upload(self.server, joined, "pace=fast&name=j.apt", "joined")
        self.assertEqual(finish(self.server, run["id"], "joined")["state"], "finished")
        removed = self.server.info()["removed_volume_mm3"]
        self.assertAlmostEqual(self.server.info("joined")["removed_volume_mm3"], removed,
                               delta=0.02 * removed)
        for query, code in (("from=x", "bad_span"), ("to=-1", "bad_span"),
                            ("tolerance_mm=-1", "bad_tolerance_mm"),
                            ("participant=x", "bad_participant")):
            status, _, body = self.get(f"program.ngc?{query}")
            self.assertEqual((status, json.loads(body)["error"]["code"]), (400, code))

    def test_forces_have_one_line_per_motion_and_the_whole_volume(self):
        status, headers, body = self.get("forces.csv")
        self.assertEqual((status, headers["content-type"]), (200, "text/csv"))
        lines = body.decode().splitlines()
        self.assertEqual(lines[0], "t_s,x,y,z,i,j,k,fx_n,fy_n,fz_n,tx_nmm,ty_nmm,tz_nmm,"
                                   "removed_mm3,imprint_mm3")
        info = self.server.info()
        self.assertEqual(len(lines) - 1, info["motions"])
        removed = sum(float(line.split(",")[13]) for line in lines[1:])
        self.assertAlmostEqual(removed, info["removed_volume_mm3"], delta=1e-6 * removed)
        one = self.get(f"forces.csv?participant={self.agent.participant}")[2].decode().splitlines()
        self.assertEqual(len(one) - 1, 299)
        felt = self.get("forces.csv?device_limits=0.01,1e9")[2].decode().splitlines()
        self.assertTrue(felt[0].startswith(lines[0] + ",felt_fx_n,felt_fy_n,"))
        self.assertEqual([line.rsplit(",", 6)[0] for line in felt[1:]], lines[1:])
        for row in ([float(value) for value in line.split(",")] for line in felt[1:]):
            computed, shown = math.hypot(*row[7:10]), math.hypot(*row[15:18])
            self.assertAlmostEqual(shown, min(computed, 0.01), delta=1e-6)

    def test_thin_walls_are_searched_on_demand(self):
        status, headers, body = self.get("thin_walls.json")
        self.assertEqual(status, 200)
        self.assertEqual(headers["content-type"], "application/json")
        report = json.loads(body)
        self.assertEqual(report["pitch_mm"], 0.5)
        self.assertEqual(report["count"], len(report["walls"]))
        self.assertIsNone(report["target"])

    def test_journal_opens_elsewhere_with_the_same_hash(self):
        status, _, body = self.get("journal")
        self.assertEqual(status, 200)
        with open(os.path.join(self.folder.name, "copy.kerf"), "wb") as file:
            file.write(body)
        expected = self.server.hash()
        self.server.stop()
        self.server = Server(self.folder.name)
        self.assertEqual(self.server.hash("copy"), expected)
        self.assertEqual(self.server.hash("block"), expected)


class Restarts(LiveTest):
    def restart(self, how):
        code, log = self.server.stop(how)
        self.server = Server(self.folder.name)
        self.port = self.server.port
        return code, log

    def test_killed_server_restarts_with_the_same_hash(self):
        agent = Agent(self.port, "block")
        carve(agent, 300)
        before = self.server.info()
        until(self, lambda: self.server.info()["journal_lag"], 0)
        code, _ = self.restart(signal.SIGKILL)
        self.assertEqual(code, -signal.SIGKILL)
        after = self.server.info()
        self.assertEqual(after["state_hash"], before["state_hash"])
        self.assertEqual(after["motions"], before["motions"])
        self.assertEqual(after["epoch"], before["epoch"] + 1)
        ada = Agent(self.port, "block")
        self.assertGreater(ada.participant, agent.participant)
        carve(ada, 100, 1.0)

    def test_mesh_stock_is_stored_in_the_journal(self):
        # A downloaded model is carved further; its file may be deleted.
        carve(Agent(self.port, "block"), 100)
        _, _, model = self.server.http.request("GET", "/v1/sessions/block/model.ply")
        code, log = self.server.stop()
        self.assertEqual(code, 0, log)
        with tempfile.TemporaryDirectory(prefix="kerf-mesh-") as folder:
            with open(os.path.join(folder, "model.ply"), "wb") as file:
                file.write(model)
            with open(os.path.join(folder, "again.json"), "w") as file:
                json.dump(dict(SCENE, name="again",
                               stock={"shape": "mesh", "file": "model.ply"}), file)
            self.server = Server(self.folder.name, "--scene", os.path.join(folder, "again.json"))
            self.port = self.server.port
        again = self.server.info("again")
        block = self.server.info("block")
        left = block["stock_volume_mm3"] - block["removed_volume_mm3"]
        self.assertAlmostEqual(again["stock_volume_mm3"], left, delta=0.01 * left)
        carve(Agent(self.port, "again"), 100, 2.0)
        expected = self.server.info("again")
        self.assertGreater(expected["removed_volume_mm3"], 0)
        until(self, lambda: self.server.info("again")["journal_lag"], 0)
        self.restart(signal.SIGKILL)
        found = self.server.info("again")
        self.assertEqual(found["state_hash"], expected["state_hash"])
        self.assertEqual(found["stock_volume_mm3"], again["stock_volume_mm3"])
        # A scene from the network may name uploaded files but not read the server's disk.
        status, body = self.server.http.json("POST", "/v1/files?name=model.ply", model)
        self.assertEqual(status, 201, body)
        posted = dict(SCENE, name="posted", stock={"shape": "mesh", "file": body["file"]})
        self.server.create("posted", posted)
        self.assertEqual(self.server.info("posted")["stock_volume_mm3"],
                         again["stock_volume_mm3"])
        leaky = b"v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9\nf 1 3 2\nf 1 2 4\nf 2 3 4\n"
        status, body = self.server.http.json("POST", "/v1/files?name=leaky.obj&repair=1", leaky)
        self.assertEqual(status, 201, body)
        self.assertIn("closed 1 hole", body["repaired"])
        stock = {"shape": "mesh", "file": body["file"], "repair": True}
        self.server.create("closed", dict(SCENE, name="closed", stock=stock))
        self.assertAlmostEqual(self.server.info("closed")["stock_volume_mm3"], 9 ** 3 / 6, delta=9)
        for name, sent, code in (("model.ply", model[:-20], "truncated"),
                                 ("model.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
                                  "not_closed"),
                                 ("model.obj&repair=1", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
                                  "not_repairable"),
                                 ("model.step", model, "bad_name"), ("", model, "bad_name")):
            status, body = self.server.http.json("POST", f"/v1/files?name={name}", sent)
            self.assertEqual((status, body["error"]["code"]), (400, code), body)
        self.assertEqual(self.server.http.request("GET", "/v1/files")[0], 405)
        shutil.rmtree(os.path.join(self.folder.name, "uploads"))
        expected = self.server.hash("posted")
        self.restart(signal.SIGKILL)
        self.assertEqual(self.server.hash("posted"), expected)
        status, body = self.server.http.json(
            "POST", "/v1/sessions",
            json.dumps(dict(SCENE, stock={"shape": "mesh", "file": "model.ply"})))
        self.assertEqual((status, body["error"]["code"], body["error"]["path"]),
                         (400, "bad_scene", "stock.file"))

    def test_server_killed_while_carving_keeps_a_prefix(self):
        agent = Agent(self.port, "block")
        carve(agent, 100)
        for i in range(200):  # the answers are not read
            agent.move([(i * 0.05, i * 0.01, -2)])
        code, _ = self.restart(signal.SIGKILL)
        info = self.server.info()
        self.assertGreaterEqual(info["motions"], 0)
        self.assertLessEqual(info["motions"], 300)
        carve(Agent(self.port, "block"), 50)

    def test_terminated_server_sends_bye_and_loses_nothing(self):
        agent = Agent(self.port, "block")
        viewer = Viewer(self.port, "block")
        carve(agent, 100)
        before = self.server.hash()
        code, log = self.restart(signal.SIGTERM)
        self.assertEqual(code, 0, log)
        for peer in (agent, viewer):
            self.assertIn("shutting down", peer.receive_json("bye")["reason"])
            with self.assertRaises(Closed):
                peer.receive(5)
        self.assertEqual(self.server.hash(), before)

    def test_damaged_journals_do_not_affect_other_sessions(self):
        agent = Agent(self.port, "block")
        carve(agent, 200)
        agent.close()
        self.server.create("other")
        expected = self.server.hash()
        self.server.stop()
        path = os.path.join(self.folder.name, "block.kerf")
        for name in ("flipped", "foreign", "truncated"):
            shutil.copy(path, os.path.join(self.folder.name, name + ".kerf"))
        with sqlite3.connect(os.path.join(self.folder.name, "flipped.kerf")) as flipped:
            first = flipped.execute("SELECT max(first) FROM batches").fetchone()[0]
            flipped.execute("UPDATE batches SET bytes = zeroblob(7) WHERE first = ?", (first,))
        with sqlite3.connect(os.path.join(self.folder.name, "foreign.kerf")) as foreign:
            foreign.execute("PRAGMA user_version = 99")
        flipped.close()
        foreign.close()
        os.truncate(os.path.join(self.folder.name, "truncated.kerf"), 9000)
        with open(os.path.join(self.folder.name, "text.kerf"), "w") as text:
            text.write("this is no database, but long enough to be taken for one " * 20)
        self.server = Server(self.folder.name)
        sessions = [s["id"] for s in self.server.http.json("GET", "/v1/sessions")[1]["sessions"]]
        self.assertEqual(sessions, ["block", "other"])
        self.assertEqual(self.server.hash(), expected)
        code, log = self.server.stop()
        self.assertIn(f"flipped.kerf: record {first}: the checksum of the records is wrong", log)
        self.assertIn("foreign_journal_version", log)
        self.assertIn("truncated.kerf", log)
        self.assertIn("not_a_journal", log)

    def test_scene_option_creates_a_session_once(self):
        scene = os.path.join(self.folder.name, "scene.json")
        with open(scene, "w") as file:
            json.dump(dict(SCENE, name="From File"), file)
        self.server.stop()
        self.server = Server(self.folder.name, "--scene", scene)
        carve(Agent(self.server.port, "from-file"), 50)
        expected = self.server.hash("from-file")
        self.server.stop()
        self.server = Server(self.folder.name, "--scene", scene)
        self.assertEqual(self.server.hash("from-file"), expected)


class Control(LiveTest):
    def test_sessions_are_created_listed_closed_and_purged(self):
        http = self.server.http
        status, headers, body = http.request("POST", "/v1/sessions", json.dumps(SCENE))
        self.assertEqual(status, 201)
        self.assertEqual(json.loads(body)["id"], "block-2")  # the name's id is taken
        self.assertEqual(headers["location"], "/v1/sessions/block-2")
        agent = Agent(self.port, "block-2")
        self.assertEqual(http.json("DELETE", "/v1/sessions/block-2")[0], 200)
        self.assertIn("closed", agent.receive_json("bye")["reason"])
        self.assertEqual(http.json("GET", "/v1/sessions/block-2")[0], 404)
        self.assertEqual(len(glob.glob(self.folder.name + "/closed/block-2-*.kerf")), 1)
        self.assertEqual(http.json("DELETE", "/v1/sessions/block?purge=1")[0], 200)
        self.assertEqual(glob.glob(self.folder.name + "/block*.kerf*"), [])
        self.assertEqual(http.json("GET", "/v1/sessions")[1]["sessions"], [])

    def test_session_info(self):
        Viewer(self.port, "block")
        info = self.server.info()
        self.assertEqual(info["stock_volume_mm3"], 40 * 40 * 20)
        self.assertEqual(info["stock"]["shape"], "box")
        self.assertEqual([tool["id"] for tool in info["tools"]], [1, 2])
        self.assertEqual(info["participants"][0]["kind"], "viewer")

    def test_health_and_metrics(self):
        carve(Agent(self.port, "block"), 20)
        self.assertEqual(self.server.http.json("GET", "/healthz"), (200, {"status": "ok"}))
        text, end = "", time.monotonic() + 10
        # A response is counted after it was sent, so the metrics may be read before.
        while "kerf_turnaround_seconds_count 20" not in text and time.monotonic() < end:
            _, headers, body = self.server.http.request("GET", "/metrics")
            text = body.decode()
        self.assertIn("text/plain", headers["content-type"])
        self.assertIn("kerf_sessions 1", text)
        self.assertIn('kerf_connections{kind="agent"} 1', text)
        self.assertIn('kerf_session_motions{session="block"} 19', text)
        self.assertIn("kerf_turnaround_seconds_count 20", text)

    def test_two_requests_on_one_connection(self):
        import http.client
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=10)
        for _ in range(3):
            connection.request("GET", "/healthz")
            self.assertEqual(connection.getresponse().read(), b'{"status":"ok"}\n')
        connection.close()

    def test_viewer_files_are_served(self):
        web = os.path.join(self.folder.name, "web")
        os.makedirs(os.path.join(web, "assets"))
        for name, text in (("index.html", "<p>hi"), ("assets/a.js", "1"), (".secret", "x")):
            with open(os.path.join(web, name), "w") as file:
                file.write(text)
        self.server.stop()
        self.server = Server(self.folder.name, "--web", web)
        get = self.server.http.request
        self.assertEqual(get("GET", "/?session=block")[2], b"<p>hi")
        status, headers, _ = get("GET", "/assets/a.js")
        self.assertEqual((status, headers["content-type"]), (200, "text/javascript; charset=utf-8"))
        self.assertIn("immutable", headers["cache-control"])
        for path in ("/.secret", "/assets", "/assets/..%2findex.html", "/nothing"):
            self.assertEqual(get("GET", path)[0], 404, path)


if __name__ == "__main__":
    run_tests()
