#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Exports programs for each machine, executes them with LinuxCNC's interpreter and carves its canonical moves.

usage: export_to_rs274.py KERF_CARVE [--rs274 PATH]
LinuxCNC must accept every exported program (exit status 0), and carving the canonical moves must give the same block as
carving the original program, within the tolerance of the export. Exit status: 77 (skipped) if rs274 is missing.
"""
import argparse
import json
import math
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from rs274 import ORDER, private_home

TOLERANCE_MM = 0.02
PITCH_MM = 0.1
MESH_MM = 0.1 * PITCH_MM  # a mesh represents a wall to a fraction of a pitch; a tiny shift moves vertices by that much
PRINTED_MM = 2e-4  # rs274 prints four decimals, also of degrees, at 30 mm from the axis


def scene(kinematics):
    return {"name": "part (of a test)", "stock": {"shape": "box", "min_mm": [-20, -20, -12], "max_mm": [20, 20, 0]},
            "accuracy": {"rays": "dexel", "pitch_mm": PITCH_MM, "tolerance_mm": 0.002, "motion": "tight"},
            "tools": [{"id": 1, "shape": "ball", "diameter_mm": 6, "length_mm": 30},
                      {"id": 2, "shape": "flat", "diameter_mm": 4, "length_mm": 30}],
            "machine": {"kinematics": kinematics}}


def apt(tilted):
    """Returns strokes like those of a haptic device.

    They are thousands of short motions on curves, with two tools and a jump."""
    lines = ["PARTNO/TEST", "MULTAX/ON", "UNITS/MM"]

    def pose(t, lean):
        angle = 9 * t  # the table turns more than once
        tip = (11 * math.cos(angle) * (1 - 0.3 * t), 11 * math.sin(angle) * (1 - 0.3 * t), -2 - 3 * t)
        tilt = lean * (0.1 + 0.4 * t)
        return tip + (math.sin(tilt) * math.cos(angle), math.sin(tilt) * math.sin(angle), math.cos(tilt))

    for tool in (1, 2):
        lean = (1 if tool == 1 else -1) if tilted else 0
        lines += [f"LOADTL/{tool}", "FROM/" + ",".join("%.6f" % v for v in pose(0, lean)), "FEDRAT/900,MMPM"]
        for n in range(1, 1201):
            lines.append("GOTO/" + ",".join("%.6f" % v for v in pose(n / 1200, lean)))
    # A straight line in a hundred steps, which is joined into one block.
    lines.append("FROM/-18,-15,-3,0,0,1")
    lines += ["GOTO/%.6f,-15,-3,0,0,1" % (-18 + 0.36 * n) for n in range(1, 101)]
    return "\n".join(lines + ["FINI", ""])


class Carve:
    def __init__(self, program, folder):
        self.program, self.folder = program, folder

    def __call__(self, *words):
        command = [self.program, *map(str, words), "--report", self.folder / "r.json"]
        run = subprocess.run(command, capture_output=True, text=True, cwd=self.folder)
        if run.returncode != 0:
            sys.exit(f"{' '.join(map(str, command))}: {run.stderr}")
        return json.loads((self.folder / "r.json").read_text())


def execute(rs274, folder, file):
    """Returns the canonical calls of a program; exits if LinuxCNC's interpreter rejects it."""
    for code in ("428", "429"):  # the kinematics switch is remapped by the machine's configuration
        (folder / f"{code}remap.ngc").write_text(f"o<{code}remap>sub\nM68 E3 Q{code[2]}\no<{code}remap>endsub\nM2\n")
    (folder / "m.ini").write_text(f"[RS274NGC]\nSUBROUTINE_PATH={folder}\nREMAP=M428 modalgroup=10 ngc=428remap\n"
                                  "REMAP=M429 modalgroup=10 ngc=429remap\n")
    (folder / "p.var").write_text("")
    (folder / "tool.tbl").write_text("T1 P1 D6\nT2 P2 D4\n")
    run = subprocess.run([rs274, "-i", folder / "m.ini", "-t", folder / "tool.tbl", "-v", folder / "p.var", "-g", file],
                         capture_output=True, text=True, cwd=folder, env=private_home(folder))
    complaints = [line for line in run.stderr.splitlines() if line and line != "executing"]
    if run.returncode != 0 or complaints:
        sys.exit(f"rs274 rejects {file.name}: exit {run.returncode}, {complaints[:3]}")
    return run.stdout.splitlines()


def arc_points(plane, start, words):
    """Returns points of an arc or helix, the last one its end, whose chords are within a tenth of PRINTED_MM."""
    first, second, normal = ORDER[plane]
    end1, end2, center1, center2, turns, end3 = (float(w) for w in words[:6])
    radius = math.hypot(start[first] - center1, start[second] - center2)
    angle = math.atan2(start[second] - center2, start[first] - center1)
    sweep = math.atan2(end2 - center2, end1 - center1) - angle
    sweep = sweep % math.tau if turns > 0 else -(-sweep % math.tau)
    sweep += math.tau * (turns - 1 if turns > 0 else turns + 1)
    count = 1 + int(abs(sweep) / math.sqrt(8 * 0.1 * PRINTED_MM / radius))
    for n in range(1, count + 1):
        point = [0.0] * 3
        point[first] = center1 + radius * math.cos(angle + sweep * n / count)
        point[second] = center2 + radius * math.sin(angle + sweep * n / count)
        point[normal] = start[normal] + (end3 - start[normal]) * n / count
        yield point


def canonical_to_apt(calls, kinematics):
    """Converts canonical moves to APT. Programmed positions are those of the tip while TCP is on, and always on xyz."""
    lines = ["PARTNO/CANON", "MULTAX/ON", "UNITS/MM", "FEDRAT/900,MMPM"]
    tool, cutting, followed, at, plane = 0, False, kinematics == "xyz", None, "XY"
    for call in calls:
        match = re.search(r"N\S+\s+(\w+)\((.*)\)", call)
        if not match:
            continue
        name, words = match.group(1), [w.strip() for w in match.group(2).split(",")]
        if name == "CHANGE_TOOL":
            tool, cutting = int(words[0]), False
            lines.append(f"LOADTL/{tool}")
        elif name == "SET_MOTION_OUTPUT_VALUE" or name == "SET_AUX_OUTPUT_VALUE":
            followed, cutting = float(words[1]) == 8, False
        elif name == "SELECT_PLANE":
            plane = words[0][-2:]
        elif name == "ARC_FEED":
            assert kinematics == "xyz", "arcs do not turn tables"
            if not cutting:
                lines.append(f"FROM/{at}")
            cutting = True
            for point in arc_points(plane, [float(v) for v in at.split(",")[:3]], words):
                at = ",".join("%.6f" % v for v in (*point, 0, 0, 1))
                lines.append(f"GOTO/{at}")
        elif name in ("STRAIGHT_TRAVERSE", "STRAIGHT_FEED"):
            x, y, z, a, b, c = (float(w) for w in words[:6])
            tilt, turn = math.radians(a if "xyzac" in kinematics else b), math.radians(c)
            if "xyzac" in kinematics:
                axis = (math.sin(turn) * math.sin(tilt), math.cos(turn) * math.sin(tilt), math.cos(tilt))
            elif "xyzbc" in kinematics:
                axis = (-math.cos(turn) * math.sin(tilt), math.sin(turn) * math.sin(tilt), math.cos(tilt))
            else:
                axis = (0, 0, 1)
            pose = ",".join("%.6f" % v for v in (x, y, z, *axis))
            if name == "STRAIGHT_FEED" and followed:
                if not cutting:
                    lines.append(f"FROM/{at}")
                cutting = True
                lines.append(f"GOTO/{pose}")
            else:
                cutting = False
            at = pose
    return "\n".join(lines + ["FINI", ""])


def check(carve, rs274, folder, kinematics):
    (folder / "s.json").write_text(json.dumps(scene(kinematics)))
    (folder / "in.apt").write_text(apt(kinematics != "xyz"))
    original = carve("--scene", "s.json", "--program", "in.apt", "--stl", "in.stl", "--ngc", "exact.ngc")
    joined = carve("--scene", "s.json", "--program", "in.apt", "--ngc", "out.ngc", "--nc-tolerance", TOLERANCE_MM)
    assert joined["state_hash"] == original["state_hash"]
    text, exact = (folder / "out.ngc").read_text(), (folder / "exact.ngc").read_text()
    assert f"strays more than {TOLERANCE_MM} mm" in text and "strays" not in exact
    blocks, before = len(text.splitlines()), len(exact.splitlines())
    assert blocks * 3 < before, f"{kinematics}: {before} blocks were joined into {blocks} only"
    calls = execute(rs274, folder, folder / "out.ngc")
    execute(rs274, folder, folder / "exact.ngc")
    (folder / "canon.apt").write_text(canonical_to_apt(calls, kinematics))
    again = carve("--scene", "s.json", "--program", "canon.apt", "--deviation", "in.stl")
    removed, found = original["removed_volume_mm3"], again["removed_volume_mm3"]
    area = 2 * 2 * 40 * 40
    if abs(found - removed) > (TOLERANCE_MM + PRINTED_MM) * area / 4:
        sys.exit(f"{kinematics}: {removed} mm3 removed by the original, {found} mm3 by LinuxCNC's canonical moves")
    figures = again["deviation"]
    if figures["p99_mm"] > TOLERANCE_MM + PRINTED_MM + MESH_MM:
        sys.exit(f"{kinematics}: 1 % of the surface is more than {figures['p99_mm']} mm off")
    print(f"{kinematics}: {before} lines joined into {blocks}; removed {removed:.3f} and {found:.3f} mm3, "
          f"rms {figures['rms_mm']:.5f}, 99 % within {figures['p99_mm']:.5f}, all within "
          f"{max(-figures['min_mm'], figures['max_mm']):.3f} mm")


HOLES = """G21 G90 G94 F100
T1 M6
G0 X-15 Y-15
Z10
G99 G81 X-10 Y-15 Z-4 R2
X-5
X0 Y-12
G80
G98 G83 X5 Y-10 Z-9.5 R1 Q2.5 F80
X10
G80
T2 M6
G0 X0 Y0
Z10
G99 G73 X0 Y5 Z-5 R2 Q3 F90
Y10
G82 Y15 Z-1 R2 P0.5 F120
G80
G0 Z20
M2
"""


def moves(calls):
    """Returns the moves and dwells that begin at or lead into a hole, and the tools.

    Approaches differ only above the holes."""
    kept = [re.sub(r"^.*N\S+\s+", "", c) for c in calls if re.search("STRAIGHT_FEED|DWELL|CHANGE_TOOL", c)]
    return [c for c in kept if c]


def check_holes(carve, rs274, folder):
    """LinuxCNC must drill the same holes with the exported cycles as with those of the source."""
    (folder / "s.json").write_text(json.dumps(scene("xyz")))
    (folder / "holes.ngc").write_text(HOLES)
    carve("--scene", "s.json", "--program", "holes.ngc", "--ngc", "cycles.ngc")
    text = (folder / "cycles.ngc").read_text()
    for cycle in ("G99 G81", "G98 G83", "G99 G73", "G99 G82"):
        assert cycle in text, f"{cycle} is not in the exported program:\n{text}"
    before, after = (moves(execute(rs274, folder, folder / name)) for name in ("holes.ngc", "cycles.ngc"))
    if before != after:
        sys.exit("LinuxCNC drills otherwise:\n" + "\n".join(before) + "\n\n" + "\n".join(after))
    feeds = sum("STRAIGHT_FEED" in call for call in before)
    print(f"holes: {feeds} feeds and {len(before) - feeds} dwells and tool changes are those of the source")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("carve")
    parser.add_argument("--rs274", default=shutil.which("rs274"))
    args = parser.parse_args()
    if not args.rs274:
        print("skipped: rs274 is not installed")
        return 77
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for kinematics in ("xyz", "xyzac-trt", "xyzbc-trt"):
            check(Carve(Path(args.carve).resolve(), folder), args.rs274, folder, kinematics)
        check_holes(Carve(Path(args.carve).resolve(), folder), args.rs274, folder)
    return 0


sys.exit(main())
