#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Carves two real programs with kerf-carve and passes the output to other programs.

usage: carve_real_programs.py KERF_CARVE SCENES_FOLDER COUNT_CROSSINGS
KERF_LINUXCNC_DIR names the folder with 3D_Chips.ngc and boat-xyzac.ngc (and rs274, if any); without it the test is skipped
(exit status 77). For each: the STL is closed and without degenerate facets (admesh), and no two facets intersect (by exact
predicates, COUNT_CROSSINGS), with one field of rays and with three, at 1 and 0.5 mm (and 0.25 and 0.1 mm where KERF_EFFORT
is above 1), its volume is the block's less what was removed, and the exported APT program, carved again, gives the same state
hash. So does the exported G-code of the three-axis program; that of the five-axis one, whose rotary words have six decimals,
gives the same removed volume to 0.01 mm3.
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

from rs274 import private_home


def carve(kerf_carve, scene, program, folder, name, outputs, options=()):
    report = os.path.join(folder, name + ".json")
    command = [kerf_carve, "--scene", scene, "--program", program, "--report", report, *options]
    for kind in outputs:
        command += ["--" + kind, os.path.join(folder, f"{name}.{kind}")]
    subprocess.run(command, check=True)
    with open(report, encoding="utf-8") as file:
        return json.load(file)


def check_mesh(stl, report, volume_error=0.01):
    subprocess.run([sys.argv[3], "1", stl], check=True, stdout=subprocess.DEVNULL)
    out = subprocess.run(["admesh", "-n", stl], check=True, capture_output=True, text=True).stdout
    count = lambda what: int(re.search(what + r"\s*:\s*(\d+)", out).group(1))
    volume = float(re.search(r"Volume\s*:\s*([\d.eE+-]+)", out).group(1))
    expected = report["stock_volume_mm3"] - report["removed_volume_mm3"]
    for fault in ("Total disconnected facets", "Degenerate facets", "Facets reversed", "Backwards edges"):
        assert count(fault) == 0, f"{fault}: {count(fault)}"
    assert abs(volume / expected - 1) < volume_error, f"mesh has {volume} mm3, the dexels {expected}"
    assert report["triangles"] > 1000


def check_every_resolution(kerf_carve, scene, program, folder, name):
    pitches = ["1", "0.5"] + (["0.25", "0.1"] if float(os.environ.get("KERF_EFFORT", "1")) > 1 else [])
    for pitch in pitches:
        for rays in ("dexel", "tri-dexel"):
            run = f"{name}-{pitch}-{rays}"
            report = carve(kerf_carve, scene, program, folder, run, ["stl"], ["--pitch", pitch, "--rays", rays])
            check_mesh(os.path.join(folder, run + ".stl"), report, 0.03)
            print(f"{run}: {report['triangles']} triangles, closed")


def check(kerf_carve, scenes, folder, linuxcnc, name, file, same_gcode_hash):
    scene = os.path.join(scenes, name + ".json")
    first = carve(kerf_carve, scene, os.path.join(linuxcnc, file), folder, name,
                  ["stl", "glb", "apt", "ngc"])
    check_mesh(os.path.join(folder, name + ".stl"), first)
    check_every_resolution(kerf_carve, scene, os.path.join(linuxcnc, file), folder, name)
    again = {kind: carve(kerf_carve, scene, os.path.join(folder, f"{name}.{kind}"), folder,
                         f"{name}-again-{kind}", []) for kind in ("apt", "ngc")}
    assert again["apt"]["state_hash"] == first["state_hash"], "APT does not bring the block back"
    if same_gcode_hash:
        assert again["ngc"]["state_hash"] == first["state_hash"], "G-code does not bring the block back"
    difference = again["ngc"]["removed_volume_mm3"] - first["removed_volume_mm3"]
    assert abs(difference) < 0.01, f"G-code removes {difference} mm3 more"
    rs274 = shutil.which("rs274")
    if rs274 and same_gcode_hash:
        subprocess.run([rs274, "-g", os.path.join(folder, name + ".ngc")], check=True,
                       stdout=subprocess.DEVNULL, env=private_home(folder))
    print(f"{name}: {first['motions']} motions, {first['removed_volume_mm3']:.3f} mm3, "
          f"{first['triangles']} triangles, {first['state_hash']}")


def main():
    linuxcnc = os.environ.get("KERF_LINUXCNC_DIR", "")
    if not os.path.isfile(os.path.join(linuxcnc, "3D_Chips.ngc")):
        print("skipped: KERF_LINUXCNC_DIR names no folder with 3D_Chips.ngc (./test.sh fetches it)")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as folder:
        check(sys.argv[1], sys.argv[2], folder, linuxcnc, "chips", "3D_Chips.ngc", True)
        check(sys.argv[1], sys.argv[2], folder, linuxcnc, "boat", "boat-xyzac.ngc", False)


main()
