#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Opens the models that kerf-carve writes in other programs, and prints a table of their results.

usage: open_models.py KERF_CARVE [FOLDER]

A long check, run by hand: it needs packages of the section `develop` of docker/packages.txt, and tests/e2e/packages.sh
for the validator of glTF. A program that is not installed is left out. Each program reads a part of 3,000 to 20,000
triangles and states its volume, and where it can whether the surface is closed; PrusaSlicer also slices it, OpenSCAD also
cuts a corner off it. A cell is `ok`, with what else the program says, or its reason to refuse. Exits with 1 if a program
reads another volume than that of the block, or another name than that of the scene; what a program cannot read is no failure.
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

PROGRAM = """G21 G90 G17
T1 M6
G0 Z5
G0 X10 Y10
G1 Z-6 F600
X30 F1500
Y20
X10
Y10
G0 Z5
T2 M6
G0 X22 Y8
G1 Z-3 F600
G3 X22 Y8 I-6 J6 F1500
G1 X38 Y26 Z-1
G0 Z5
M2
"""
NAME = "bracket left 2"
FILES = {  # file: options of kerf-carve
    "part.stl": ["--stl"],
    "ascii.stl": ["--stl-encoding", "ascii", "--stl"],
    "part.3mf": ["--3mf"],
    "part.ply": ["--ply"],
    "part.obj": ["--obj"],
    "part.glb": ["--glb"],
    "quantized.glb": ["--glb-encoding", "quantized", "--glb"],
    "meshopt.glb": ["--glb-encoding", "meshopt", "--glb"],
}
VOLUME_ERROR = 2e-3  # of the block: its dexels and its surface differ by chords; quantized models by steps


def run(command, **more):
    done = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=300, check=False, **more)
    return done.returncode, done.stdout + done.stderr


def carve(kerf_carve, folder):
    """Writes all files; returns the volume of the part, mm3."""
    path = lambda name: os.path.join(folder, name)
    with open(path("part.nc"), "w", encoding="ascii") as file:
        file.write(PROGRAM)
    tools = ["--tool", "1=6", "--tool", "2=4mm ball"]
    derived = [kerf_carve, path("part.nc"), "--stock", "40,30,12", *tools, "--pitch", "0.4"]
    subprocess.run([*derived, "--write-scene", path("scene.json")], check=True, capture_output=True)
    with open(path("scene.json"), encoding="utf-8") as file:
        scene = json.load(file)
    scene["name"] = NAME
    with open(path("scene.json"), "w", encoding="utf-8") as file:
        json.dump(scene, file)
    for name, options in FILES.items():
        command = [kerf_carve, "--scene", path("scene.json"), "--program", path("part.nc"), "--report", path("report.json")]
        subprocess.run([*command, *options, path(name)], check=True, capture_output=True)
    with open(path("report.json"), encoding="utf-8") as file:
        report = json.load(file)
    return report["stock_volume_mm3"] - report["removed_volume_mm3"]


class Refused(Exception):
    pass


def number(text, pattern):
    found = re.search(pattern, text)
    if not found:
        raise Refused(next((line.strip() for line in text.splitlines() if re.search("rror|not|nable|nknown", line)), "no answer"))
    return float(found.group(1))


def admesh(file):
    _, text = run(["admesh", "-n", file])
    volume = number(text, r"Volume\s*:\s*([\d.eE+-]+)")
    faults = number(text, r"Total disconnected facets\s*:\s*(\d+)") + number(text, r"Degenerate facets\s*:\s*(\d+)")
    return volume, "closed" if faults == 0 else f"{faults:.0f} faulty facets"


def prusa_slicer(file):
    _, text = run(["prusa-slicer", "--info", file])
    volume = number(text, r"volume = ([\d.eE+-]+)")
    closed = "manifold = yes" in text
    gcode = os.path.join(os.path.dirname(file), "sliced.gcode")
    code, log = run(["prusa-slicer", "--export-gcode", "--output", gcode, file])
    sliced = "sliced" if code == 0 and os.path.getsize(gcode) > 0 else "not sliced: " + log.strip().splitlines()[-1]
    return volume, ("closed, " if closed else "not closed, ") + sliced


def openscad(file):
    folder = os.path.dirname(file)
    script, out = os.path.join(folder, "cut.scad"), os.path.join(folder, "cut.stl")
    with open(script, "w", encoding="ascii") as text:
        # The stock spans -Z to 0 around the cuts; a cube at its lowest corner is cut off.
        text.write(f'difference() {{ import("{file}"); translate([-500, -500, -500]) cube([505, 505, 490]); }}\n')
    code, log = run(["openscad", "-o", out, script])
    if code != 0 or "WARNING" in log or "ERROR" in log:
        raise Refused(next(line for line in log.splitlines() if "WARNING" in line or "ERROR" in line))
    volume, closed = admesh(out)
    return None, f"boolean: {volume:.1f} mm3, {closed}"


FREECAD = """
import Mesh, sys
m = Mesh.Mesh(sys.argv[-1])
print("volume", m.Volume, "solid", m.isSolid(), "manifold", not m.hasNonManifolds(), "crossing", m.hasSelfIntersections())
"""


def freecad(file):
    script = os.path.join(os.path.dirname(file), "read.py")
    with open(script, "w", encoding="ascii") as text:
        text.write(FREECAD.replace("sys.argv[-1]", repr(file)))
    _, log = run(["freecadcmd", script])
    volume = number(log, r"volume ([\d.eE+-]+)")
    sound = "solid True manifold True crossing False" in log
    return volume, "solid" if sound else re.search("solid .*", log).group(0)


BLENDER = """
import bpy, bmesh, numpy, sys
numpy.bool = bool  # Debian's importer of glTF uses this former name
file = sys.argv[-1]
bpy.ops.wm.read_factory_settings(use_empty=True)
kind = file.rsplit(".", 1)[1]
if kind == "stl": bpy.ops.import_mesh.stl(filepath=file)
elif kind == "ply": bpy.ops.import_mesh.ply(filepath=file)
elif kind == "obj": bpy.ops.wm.obj_import(filepath=file, forward_axis="Y", up_axis="Z")
elif kind == "glb": bpy.ops.import_scene.gltf(filepath=file)
else: sys.exit("no importer for ." + kind)
volume, names, open_edges = 0, [], 0
for o in bpy.data.objects:
    names.append(o.name if o.type != "MESH" else o.name + "/" + o.data.name)
    if o.type != "MESH": continue
    b = bmesh.new(); b.from_mesh(o.data); b.transform(o.matrix_world)
    bmesh.ops.remove_doubles(b, verts=b.verts, dist=1e-7)
    volume += b.calc_volume()
    open_edges += sum(not e.is_manifold for e in b.edges)
print("volume", volume * (1e9 if kind == "glb" else 1), "names", names, "open", open_edges)
"""


def blender(file):
    script = os.path.join(os.path.dirname(file), "blend.py")
    with open(script, "w", encoding="ascii") as text:
        text.write(BLENDER)
    # Blender looks for its Python modules next to the first python3 in the PATH.
    system = {**os.environ, "PATH": "/usr/bin:/bin"}
    _, log = run(["blender", "--background", "--factory-startup", "--python", script, "--", file], env=system)
    volume = number(log, r"volume ([\d.eE+-]+) names")
    names = re.search(r"names (\[.*\]) open", log).group(1)
    if file.endswith(".glb") and names != repr([f"{NAME}/{NAME}"]):
        raise AssertionError(f"{file} is named {names} in Blender")
    open_edges = int(re.search(r"open (\d+)", log).group(1))
    return volume, names.strip("[]") + (", closed" if open_edges == 0 else f", {open_edges} open edges")


def assimp(file):
    code, text = run(["assimp", "info", file])
    if code != 0:
        raise Refused(text.strip().splitlines()[-1])
    faces = number(text, r"Faces:\s*(\d+)")
    return None, f"{faces:.0f} triangles"


def validator(file):
    if not file.endswith(".glb"):
        raise Refused("not glTF")
    script = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../e2e/validate_glb.mjs")
    code, text = run(["node", script, file])
    if "ERR_MODULE_NOT_FOUND" in text:
        raise Refused("tests/e2e/packages.sh has not been run")
    if code != 0:
        raise AssertionError(text)
    return None, "no errors and warnings"


PROGRAMS = {
    "admesh": ("admesh", admesh, (".stl",)),
    "PrusaSlicer": ("prusa-slicer", prusa_slicer, (".stl", ".3mf", ".obj")),
    "OpenSCAD": ("openscad", openscad, (".stl", ".3mf")),
    "FreeCAD": ("freecadcmd", freecad, (".stl", ".3mf", ".ply", ".obj")),
    "Blender": ("blender", blender, (".stl", ".ply", ".obj", ".glb")),
    "assimp": ("assimp", assimp, (".stl", ".3mf", ".ply", ".obj", ".glb")),
    "gltf-validator": ("node", validator, (".glb",)),
}


def main():
    folder = sys.argv[2] if len(sys.argv) > 2 else tempfile.mkdtemp(prefix="kerf-models-")
    os.makedirs(folder, exist_ok=True)
    expected = carve(os.path.abspath(sys.argv[1]), os.path.abspath(folder))
    print(f"the part: {expected:.1f} mm3\n\n| program | file | result |\n|---|---|---|")
    failed = False
    for program, (command, read, kinds) in PROGRAMS.items():
        if shutil.which(command) is None:
            print(f"| {program} | | is not installed |")
            continue
        for name in FILES:
            if os.path.splitext(name)[1] not in kinds:
                continue
            try:
                volume, text = read(os.path.join(os.path.abspath(folder), name))
                wrong = volume is not None and abs(volume - expected) > VOLUME_ERROR * expected
                failed = failed or wrong
                said = "" if volume is None else f"{volume:.1f} mm3, "
                print(f"| {program} | {name} | {'WRONG: ' if wrong else 'ok: '}{said}{text} |", flush=True)
            except Refused as reason:
                print(f"| {program} | {name} | refused: {reason} |", flush=True)
            except (AssertionError, subprocess.TimeoutExpired) as reason:
                failed = True
                print(f"| {program} | {name} | WRONG: {reason} |", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
