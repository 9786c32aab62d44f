#!/usr/bin/env python3
"""Reads random G-code with Kerf and with LinuxCNC's stand-alone interpreter and compares where each block ends.

usage: compare_with_rs274.py PROGRAM_POINTS SCENE [--rs274 PATH] [--programs N] [--first SEED]
rs274 comes with the Debian package linuxcnc-uspace. Exit status 77 (skipped) where it is missing.
"""
import argparse
import random
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

TOLERANCE_MM = 5e-3  # rs274 prints four decimals, in inches too
PLANES = {"G17": ("XY", "IJ", "Z"), "G18": ("XZ", "IK", "Y"), "G19": ("YZ", "JK", "X")}
ORDER = {"XY": (0, 1, 2), "XZ": (1, 2, 0), "YZ": (2, 0, 1)}  # ARC_FEED's numbers as x, y, z


class Generator:
    def __init__(self, seed):
        self.random = random.Random(seed)
        self.inch = False

    def number(self, size=20.0):
        return "%.3f" % (self.random.uniform(-size, size) / (25.4 if self.inch else 1))

    def axes(self):
        return "".join(a + self.number() for a in "XYZ" if self.random.random() < 0.6)

    def arc(self):
        r = self.random
        plane, (axes, offsets, normal) = r.choice(list(PLANES.items()))
        helix = normal + self.number() if r.random() < 0.3 else ""
        code = r.choice(["G2", "G3"])
        if r.random() < 0.7:
            ends = "".join(a + self.number() for a in axes)
            return f"G90 {plane} {code} {ends} {helix} R[{r.choice(['', '-'])}{3 if self.inch else 60}]"
        center = "".join(o + self.number() for o in offsets)
        return f"{plane} {code} {helix} {center} P{r.randint(1, 3)}"

    def block(self):
        r = self.random
        kind = r.random()
        if kind < 0.3:
            return r.choice(["G0", "G1"]) + (self.axes() or "X" + self.number())
        if kind < 0.5:
            return self.arc()
        if kind < 0.56:
            self.inch = not self.inch
            return "G20" if self.inch else "G21"
        others = [
            lambda: r.choice(["G90", "G91"]),
            lambda: f"G92 X{self.number()} Z{self.number()}",
            lambda: r.choice(["G92.1", "G92.2", "G92.3"]),
            lambda: f"G10 L{r.choice([2, 20])} P{r.randint(0, 3)} X{self.number()} Y{self.number()}",
            lambda: r.choice(["G54", "G55", "G56"]),
            lambda: f"#1=[{self.number(5)}+#1*0.5] #2=[atan[#1]/[2]/90] #3=#5420",
            lambda: "G90 G1 X[#1+#2] Y[#3/2] Z[#1 mod 3 - [#1 gt 0]]",
            lambda: f"G1 X#5420 Y[#5421+1] F{r.randint(1, 500)}",
        ]
        return r.choice(others)()

    def program(self):
        start = ["G21 G17 G90 G94 T1 M6 G54 G91.1 F100 G40 G80", "G0 X0 Y0 Z0", "G1 X0.5 F100"]
        lines = start + [self.block() for _ in range(25)] + ["M2"]
        return [f"N{i + 1} {line}" for i, line in enumerate(lines)]


def read_with_rs274(rs274, folder, file):
    """Ends of blocks by N number, in mm without offsets; and what it complains about."""
    (folder / "p.var").write_text("")
    (folder / "tool.tbl").write_text("T1 P1 Z0 D10\n")
    command = [rs274, "-t", folder / "tool.tbl", "-v", folder / "p.var", "-g", file]
    run = subprocess.run(command, capture_output=True, text=True)
    unit, system, shift, plane, ends = 1.0, [0.0] * 3, [0.0] * 3, "XY", {}
    for line in run.stdout.splitlines():
        match = re.match(r"\s*\d+ N(\S+)\s+(\w+)\((.*)\)", line)
        if not match:
            continue
        number, call, text = match.groups()
        words = [w.strip() for w in text.split(",")]
        if call == "USE_LENGTH_UNITS":
            unit = 25.4 if "INCH" in text else 1.0
        elif call == "SET_G5X_OFFSET":
            system = [float(w) * unit for w in words[1:4]]
        elif call == "SET_G92_OFFSET":
            shift = [float(w) * unit for w in words[:3]]
        elif call == "SELECT_PLANE":
            plane = text[-2:]
        elif call in ("STRAIGHT_FEED", "STRAIGHT_TRAVERSE", "ARC_FEED"):
            values = [float(w) * unit for w in words]
            if call == "ARC_FEED":
                given = (values[0], values[1], values[5])
                values = [given[i] for i in ORDER[plane]]
            ends[int(number)] = [values[i] + system[i] + shift[i] for i in range(3)]
    return ends, [l for l in run.stderr.splitlines() if l != "executing"]


def read_with_kerf(points, scene, file):
    run = subprocess.run([points, scene, file], capture_output=True, text=True)
    rows = [line.split() for line in run.stdout.splitlines() if not line.startswith("error")]
    return {int(r[0]): [float(v) for v in r[1:4]] for r in rows}, run.returncode != 0


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("points")
    parser.add_argument("scene")
    parser.add_argument("--rs274", default=shutil.which("rs274"))
    parser.add_argument("--programs", type=int, default=200)
    parser.add_argument("--first", type=int, default=0)
    args = parser.parse_args()
    if not args.rs274:
        print("rs274 is not installed: nothing compared")
        return 77
    compared = refused = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        file = folder / "p.ngc"
        for seed in range(args.first, args.first + args.programs):
            lines = Generator(seed).program()
            file.write_text("\n".join(lines) + "\n")
            theirs, complaints = read_with_rs274(args.rs274, folder, file)
            ours, error = read_with_kerf(args.points, args.scene, file)
            if bool(complaints) != error:
                print(f"seed {seed}: rs274 says {complaints}, Kerf {'refuses' if error else 'accepts'}")
                return 1
            if error:
                refused += 1
                continue
            at = [0.5, 0.0, 0.0]
            for number in range(4, len(lines) + 1):
                at = ours.get(number, at)
                if number not in theirs:
                    continue
                compared += 1
                if max(abs(a - b) for a, b in zip(at, theirs[number])) > TOLERANCE_MM:
                    print(f"seed {seed}: {lines[number - 1]}: Kerf {at}, rs274 {theirs[number]}")
                    return 1
    print(f"{compared} block ends agree; {refused} of {args.programs} programs refused by both")
    return 0


sys.exit(main())
