#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Reads random G-code with Kerf and with LinuxCNC's stand-alone interpreter and compares every canonical call.

usage: compare_with_rs274.py CANONICAL_CALLS [--rs274 PATH] [--programs N] [--first SEED] [--kind KIND]
rs274 is in the Debian package linuxcnc-uspace. Exit status: 77 (skipped) if it is missing, 1 on the first difference.
"""
import argparse
import collections
import math
import random
import shutil
import sys
import tempfile
from pathlib import Path

import rs274 as reference

PLANES = {"G17": ("XY", "IJ", "Z"), "G18": ("XZ", "IK", "Y"), "G19": ("YZ", "JK", "X")}
TOOLS = "T1 P1 D0.2\nT2 P7 Z1.5 D0.35\nT3 P3 X0.25 Z-0.5 D0.5\nT12 P12 Z0.125 D0.04\n"  # inches, the unit of rs274


class Generator:
    """Generates random programs; the same for the same seed."""

    def __init__(self, seed):
        self.random = random.Random(seed)
        self.inch = False
        self.plane = "G17"
        self.breaks = seed % 2 == 0

    def number(self, size=20.0):
        return "%.3f" % (self.random.uniform(-size, size) / (25.4 if self.inch else 1))

    def axes(self, letters="XYZ", chance=0.6):
        return "".join(a + self.number() for a in letters if self.random.random() < chance)

    def some(self, blocks, count):
        return [self.random.choice(blocks)() for _ in range(count)]

    def units(self):
        self.inch = not self.inch
        return self.offset_known("G49") + "\nG20" if self.inch else self.offset_known("G49") + "\nG21"

    def offset_known(self, block):
        # rs274 simulates the machine whose position it reads back after M6: it loses tool offsets and rotations until
        # the next move, and keeps a tool's offset in the previous units. So a move follows immediately.
        return block + "\nG90 G0 X1 Y2 Z3"

    def select(self):
        self.plane = self.random.choice(list(PLANES))
        return self.plane

    def line(self):
        return self.random.choice(["G0", "G1"]) + (self.axes() or "X" + self.number())

    def arc(self):
        r = self.random
        plane, (axes, offsets, normal) = r.choice(list(PLANES.items()))
        self.plane = plane
        helix = normal + self.number() if r.random() < 0.3 else ""
        code = r.choice(["G2", "G3"])
        if r.random() < 0.7:
            ends = "".join(a + self.number() for a in axes)
            return f"G90 {plane} {code} {ends} {helix} R[{r.choice(['', '-'])}{3 if self.inch else 60}]"
        center = "".join(o + self.number() for o in offsets)
        return f"{plane} {code} {helix} {center} P{r.randint(1, 3)}"

    def offset(self):
        r = self.random
        return r.choice([
            lambda: f"G92 X{self.number()} Z{self.number()}",
            lambda: f"G52 {self.axes('XYZC') or 'X1'}",
            lambda: r.choice(["G92.1", "G92.2", "G92.3"]),
            lambda: f"G10 L{r.choice([2, 20])} P{r.randint(0, 3)} {self.axes('XYZA') or 'X1'}",
            lambda: f"G10 L2 P{r.randint(0, 3)} R{r.randint(-90, 90)} {self.axes('XY')}",
            lambda: r.choice(["G54", "G55", "G56", "G59.3"]),
            lambda: f"G90 G53 G{r.randint(0, 1)} {self.axes('XYZ')}",
            lambda: r.choice(["G28", "G30", "G28.1", "G30.1", f"G28 {self.axes('XYZ')}", f"G30 {self.axes('XYC')}"]),
        ])()

    def tool(self):
        r = self.random
        return r.choice([
            lambda: self.offset_known("") + f"\nT{r.choice([1, 2, 3, 12])} M6",
            lambda: self.offset_known(r.choice(["G43", "G49", "G43 H2", "G43 H3", "G43 H12", "G43 H0"])),
            lambda: self.offset_known(f"G43.1 {self.axes('XZ') or 'Z1'}"),
            lambda: f"G10 L1 P{r.choice([1, 2, 3])} {self.axes('XZ') or 'Z1'} R{r.uniform(0.1, 2):.3f}",
            lambda: f"G10 L1{r.choice([0, 1])} P{r.choice([1, 2, 3])} {self.axes('XYZ') or 'Z1'}",
        ])()

    def value(self):
        r = self.random
        return r.choice([
            lambda: f"#1=[{self.number(5)}+#1*0.5] #2=[atan[#1]/[2]/90] #3=#5420",
            lambda: "G90 G1 X[#1+#2] Y[#3/2] Z[#1 mod 3 - [#1 gt 0]]",
            lambda: f"G1 X#5420 Y[#5421+1] F{r.randint(1, 500)}",
            lambda: "G1 X[#<_x>+1] Y#<_abs_y> Z[#<_metric>+#<_coord_system>/100]",
            lambda: "#4=[#5221+#5211+#5161+#5400+#5403+#5410+#5220] G1 X[#4 mod 50]",
            lambda: "#<_g>=[#<_motion_mode>+#<_plane>+#<_absolute>+#<_feed>+#<_tool_offset>] G1 Y[#<_g> mod 30]",
            lambda: f"#<a b>={self.number()} #<c>=exists[#<ab>] G1 X[#<c>*3]",
            lambda: r.choice(["G90", "G91"]),
        ])()

    def polar(self):
        r = self.random
        words = r.choice(["@{0} ^{1}", "@{0}", "^{1}"]).format(abs(float(self.number())), r.randint(-180, 360))
        return f"G17 G{r.choice([0, 1, 1])} {words}"

    def cycle(self):
        r = self.random
        axes, _, normal = PLANES[self.plane]
        kind = r.choice([73, 81, 82, 83, 85, 86, 87, 88, 89] + ([84] if self.plane == "G17" else []))
        scale = 25.4 if self.inch else 1
        top, depth = r.uniform(-2, 8) / scale, r.uniform(0.5, 8) / scale
        words = f"G{kind} {normal}{top - depth:.3f} R{top:.3f}"
        if r.random() < 0.4:
            words = f"G91 G{kind} {normal}{-depth:.3f} R{r.uniform(-3, 3) / scale:.3f} L{r.randint(1, 3)}"
        elif r.random() < 0.5:
            words = "G90 " + words
        if kind in (73, 83):
            words += f" Q{r.uniform(0.7, 3) / scale:.3f}"
        if kind in (82, 86, 88, 89):
            words += " P0.5"
        if kind == 87:
            words += f" I{self.number(3)} J{self.number(3)} K{self.number(3)}"
        blocks = [r.choice(["G98", "G99"]) + " " + words + self.axes(axes)]
        blocks += [(self.axes(axes) or axes[0] + self.number()) for _ in range(r.randint(0, 2))]
        return blocks + [r.choice(["G80", "G0 " + (self.axes() or "X0"), "G1 X1 Y1"])]

    def compensated(self):
        return self.contour() if self.random.random() < 0.7 else self.scribble()

    def start_compensation(self, axes, largest):
        r = self.random
        unit = 25.4 if self.inch else 1
        diameter = f"{r.uniform(0, largest) / unit:.3f}"
        return r.choice(["G41", "G42", f"G41.1 D{diameter}", f"G42.1 D{diameter}", "G41 D1", "G42 D2", "G41 D12"])

    def contour(self):
        """A path around a center with inside and outside corners, lines, arcs and moves along the normal."""
        r = self.random
        unit = 25.4 if self.inch else 1
        self.plane = r.choice(["G17", "G17", "G18"])
        axes, normal = ("XY", "Z") if self.plane == "G17" else ("ZX", "Y")
        turn = r.choice([1, -1])
        angles = [turn * 360 * k / 8 for k in range(r.randint(4, 9))]
        points = [(r.uniform(25, 40), a) for a in angles]

        def ends(radius, angle):
            return "".join(a + "%.3f" % (radius * f(math.radians(angle)) / unit)
                           for a, f in zip(axes, (math.cos, math.sin)))

        blocks = [f"{self.plane} G90 G0 {ends(70, angles[0] - turn * 10)}", self.start_compensation(axes, 5),
                  f"G{r.choice([0, 1])} {ends(*points[0])}"]
        for (r0, a0), (r1, a1) in zip(points, points[1:]):
            chord = math.dist((r0 * math.cos(math.radians(a0)), r0 * math.sin(math.radians(a0))),
                              (r1 * math.cos(math.radians(a1)), r1 * math.sin(math.radians(a1))))
            kind = r.random()
            if kind < 0.5:
                blocks.append(f"G1 {ends(r1, a1)}" + (f" {normal}{self.number(5)}" if r.random() < 0.2 else ""))
            elif kind < 0.9:
                blocks.append(f"G{r.choice([2, 3])} {ends(r1, a1)} R{chord * r.uniform(0.55, 3) / unit:.3f}")
            else:
                blocks += [f"G{r.choice([0, 1])} {normal}{self.number(5)}", "G4 P0.1", f"G1 {ends(r1, a1)}"]
        return blocks + ["G40", f"G{r.choice([0, 1])} {ends(60, angles[-1])}"]

    def scribble(self):
        """A random path. The tool cannot follow most of them without gouging, which both readers must report."""
        r = self.random
        self.plane = r.choice(["G17", "G17", "G18"])
        axes, centers = ("XY", "IJ") if self.plane == "G17" else ("XZ", "IK")
        unit = 25.4 if self.inch else 1
        blocks = [f"{self.plane} G90 G0 {axes[0]}{self.number(40)} {axes[1]}{self.number(40)}",
                  self.start_compensation(axes, 6)]
        for _ in range(r.randint(1, 4)):
            ends = "".join(a + self.number(30) for a in axes)
            kind = r.random()
            if kind < 0.55:
                blocks.append(f"G{r.choice([0, 1, 1, 1])} {ends}")
            elif kind < 0.8:
                blocks.append(f"G{r.choice([2, 3])} {ends} R[{r.choice(['', '', '-'])}{r.randint(20, 90) / unit:.3f}]")
            elif kind < 0.9:
                blocks.append(f"G{r.choice([2, 3])} {centers[0]}{self.number(20)} {centers[1]}{self.number(20)}")
            else:
                blocks.append(r.choice(["F200", "G91 G1 " + ends + "\nG90"]))
        return blocks + ["G40", f"G1 {axes[0]}{self.number(40)} {axes[1]}{self.number(40)}"]

    def flow(self):
        r = self.random
        label = r.randint(100, 9999)
        body = [r.choice([self.line, self.value])() for _ in range(r.randint(1, 3))]
        step = f"#5=[#5+1] G1 X[#5*1.5] Y[#5 mod 2]"
        # After a break out of a while, rs274 ends the next do after one pass, which is a bug of rs274.
        leave = "break" if self.breaks else "continue"
        return r.choice([
            lambda: [f"#5=0", f"o{label} while [#5 lt {r.randint(0, 4)}]", step, *body,
                     *([f"o{label}1 if [#5 eq 2]", f"o{label} {leave}", f"o{label}1 endif"]
                       if r.random() < 0.5 else []), f"o{label} endwhile"],
            lambda: [] if self.breaks else [f"#5=0", f"o{label} do", step, *body,
                                            f"o{label} while [#5 lt {r.randint(0, 3)}]"],
            lambda: [f"o{label} repeat [{r.randint(0, 3)}]", step, *body, f"o{label} endrepeat"],
            lambda: [f"o{label} if [#1 gt {self.number(3)}]", *body, f"o{label} elseif [#2 lt 0]", step,
                     *([f"o{label} else", "G1 Z3"] if r.random() < 0.7 else []), f"o{label} endif"],
            lambda: [f"o<s{label}> sub", "#<n>=[#1*2+#2]", f"o1 if [#1 gt 2]", f"o<s{label}> return [#<n>]", "o1 endif",
                     "G1 X#1 Y#2 Z#30", "o2 repeat [2]", "G91 G1 X0.5", "G90", "o2 endrepeat",
                     f"o<s{label}> endsub [7+#2]", f"o<s{label}> call [{self.number(4)}] [#3+1]",
                     "G1 X[#<_value>] Z#<_value_returned>", f"o<s{label}> call [{r.randint(0, 5)}]"],
            lambda: [f"M70", "G91 G20", "G1 X0.01 F10", "M72", "G1 X1 F100"],
        ])()

    def blocks(self, kind):
        motion = [self.line, self.line, self.arc, self.offset, self.value, self.select, self.units]
        if kind == "motion":
            return self.some(motion, 25)
        if kind == "tool":
            return self.some(motion + [self.tool] * 4, 25)
        if kind == "polar":
            return self.some([self.line, self.polar, self.polar, self.offset, self.value, self.units], 25)
        long = {"cycle": self.cycle, "compensation": self.compensated, "flow": self.flow}[kind]
        blocks = []
        for _ in range(6):
            blocks += self.some(motion, 2) + long()
        return blocks

    def program(self, kind):
        start = ["G21 G17 G90 G94 G54 G91.1 G40 G80 G49 G98", "T1 M6", "S500 M3 F100", "G0 X0 Y0 Z0", "G1 X0.5 F100"]
        lines = start + self.blocks(kind) + ["M2"]
        return "\n".join(lines) + "\n"


KINDS = ["motion", "tool", "polar", "cycle", "compensation", "flow"]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("canonical_calls")
    parser.add_argument("--rs274", default=shutil.which("rs274"))
    parser.add_argument("--programs", type=int, default=200)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--kind", choices=KINDS)
    parser.add_argument("--keep", help="write the program that differs to this file")
    args = parser.parse_args()
    if not args.rs274:
        print("skipped: rs274 is not installed, nothing compared")
        return 77
    count = collections.Counter()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        file, tools = folder / "p.ngc", folder / "tool.tbl"
        tools.write_text(TOOLS)
        precise = reference.with_nine_decimals(args.rs274, folder)
        for seed in range(args.first, args.first + args.programs):
            kind = args.kind or KINDS[seed % len(KINDS)]
            text = Generator(seed).program(kind)
            file.write_text(text)
            theirs, complaint = reference.with_rs274(precise, file, folder, tools)
            ours, error, _ = reference.with_kerf(args.canonical_calls, file, tools)
            # The calls before an error must agree as well.
            differs = reference.difference(ours[:len(theirs)], theirs[:len(ours)])
            if (complaint is None) != (error is None):
                differs = f"rs274: {complaint or 'accepts'}; Kerf: {error or 'accepts'}"
            elif not differs:
                differs = reference.difference(ours, theirs)
            if differs:
                print(f"seed {seed} ({kind}): {differs}")
                if args.keep:
                    Path(args.keep).write_text(text)
                return 1
            count[kind, "rejected" if error else "agree"] += 1
            count[kind, "calls"] += len(ours)
    for kind in KINDS:
        print("%-13s %4d programs agree, %3d rejected by both, %6d calls equal"
              % (kind, count[kind, "agree"], count[kind, "rejected"], count[kind, "calls"]))
    return 0


sys.exit(main())
