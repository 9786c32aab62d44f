# SPDX-License-Identifier: Apache-2.0
"""Runs LinuxCNC's stand-alone interpreter, rs274, and Kerf's reader; both return a list of canonical calls.

A call is a dictionary: kind ("rapid", "feed", "arc", "spline", "dwell"); for moves `to` (X Y Z in mm and A B C in
degrees, absolute coordinates); for arcs plane, center (in the plane, mm) and turns; for dwells seconds.
"""
import math
import os
import re
import subprocess
from pathlib import Path

# Rounding error, mm, of a number printed with nine decimals (with_nine_decimals), by the unit.
PRINTED = {1.0: 0.5e-9, 25.4: 0.5e-9 * 25.4}
# Difference allowed between the two computations: a hundredth of the required accuracy of 1e-4 mm.
COMPUTED_MM = 1e-6
ORDER = {"XY": (0, 1, 2), "XZ": (2, 0, 1), "YZ": (1, 2, 0)}  # first, second and normal axis of a plane
PLANES = {"XY": 0, "XZ": 1, "YZ": 2}
CALL = re.compile(r"\s*\d+ (?:N\S*\s+)?([A-Z]\w+)\((.*)\)\s*$")


def turned(x, y, degrees):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return x * c - y * s, x * s + y * c


class Machine:
    """Converts printed canonical calls to absolute coordinates: applies units, offsets, rotation and plane."""

    def __init__(self):
        self.unit, self.plane, self.turn = 1.0, "XY", 0.0
        self.system, self.shift = [0.0] * 6, [0.0] * 6
        self.rounded = {"system": 0.0, "shift": 0.0}
        self.calls = []

    def scaled(self, words):
        values = [float(w) for w in words]
        return [v * self.unit for v in values[:3]] + values[3:6]

    def place(self, programmed):
        axes = [p + s for p, s in zip(programmed, self.shift)]
        if self.turn:
            axes[0], axes[1] = turned(axes[0], axes[1], self.turn)
        return [a + s for a, s in zip(axes, self.system)]

    def tolerance(self, tolerance):
        """Tolerance of a position: rounding of the position and of each offset that is not zero."""
        sum_mm = PRINTED[self.unit] + self.rounded["system"] + self.rounded["shift"]
        # The angle of a rotation is rounded as well.
        far = max(map(abs, self.shift[:2])) + 100
        return tolerance + COMPUTED_MM + sum_mm * (1.5 if self.turn else 1) + (far * 2e-11 if self.turn else 0)

    def arc(self, words):
        first, second, normal = ORDER[self.plane]
        end1, end2, center1, center2, turns, end3 = (float(w) for w in words[:6])
        programmed, center = [0.0] * 6, [0.0] * 6
        programmed[first], programmed[second], programmed[normal] = (v * self.unit for v in (end1, end2, end3))
        programmed[3:] = [float(w) for w in words[6:9]]
        center[first], center[second] = center1 * self.unit, center2 * self.unit
        middle = self.place(center)
        return {"kind": "arc", "to": self.place(programmed), "plane": PLANES[self.plane],
                "center": [middle[first], middle[second]], "turns": int(turns)}

    def take(self, call, text):
        words = re.split(r"[,\s]+", text.strip())
        result = None
        if call == "USE_LENGTH_UNITS":
            unit = 25.4 if "INCH" in text else 1.0
            self.unit = unit
        elif call == "SET_G5X_OFFSET":
            self.system = self.scaled(words[1:7])
            self.rounded["system"] = PRINTED[self.unit] if any(self.system) else 0.0
        elif call == "SET_G92_OFFSET":
            self.shift = self.scaled(words[:6])
            self.rounded["shift"] = PRINTED[self.unit] if any(self.shift) else 0.0
        elif call == "SET_XY_ROTATION":
            self.turn = float(words[0])
        elif call == "SELECT_PLANE":
            self.plane = text.strip()[-2:]
        elif call in ("STRAIGHT_FEED", "STRAIGHT_TRAVERSE"):
            kind = "feed" if call == "STRAIGHT_FEED" else "rapid"
            result = {"kind": kind, "to": self.place(self.scaled(words[:6]))}
        elif call == "ARC_FEED":
            result = self.arc(words)
        elif call == "DWELL":
            result = {"kind": "dwell", "seconds": float(words[0])}
        elif call == "RIGID_TAP":  # down and back; printed without rotary axes
            start = self.calls[-1]["to"]
            down = self.place(self.scaled(words[:3]) + [0.0] * 3)
            down[3:] = start[3:]
            self.calls.append({"kind": "feed", "to": down, "tolerance": self.tolerance(0)})
            result = {"kind": "feed", "to": start}
        elif call == "NURBS_FEED":  # rs274 does not print the end
            result = {"kind": "spline"}
        elif call == "STRAIGHT_PROBE":
            result = {"kind": call}
        if result is not None:
            result["tolerance"] = self.tolerance(0)
            self.calls.append(result)


def with_nine_decimals(rs274, folder):
    """Makes a copy of rs274 in `folder` that prints nine decimals instead of four; returns its wrapper script."""
    wrapper = Path(rs274).read_text()
    program = re.search(r'exec "([^"]*rs274)"', wrapper).group(1)
    copy = folder / "rs274.bin"
    copy.write_bytes(Path(program).read_bytes().replace(b"%.4f", b"%.9f"))
    copy.chmod(0o755)
    precise = folder / "rs274"
    precise.write_text(wrapper.replace('"%s"' % program, '"%s"' % copy))
    precise.chmod(0o755)
    return precise


def private_home(folder):
    """Returns an environment with its own HOME: rs274 stores tools in a file there, which parallel runs would share."""
    return dict(os.environ, LC_ALL="C", HOME=str(folder))


def with_rs274(rs274, program, folder, tools, folders=(), timeout=20):
    """Runs rs274. Returns the calls and its complaint (None if it accepts). `folder` is for its own files."""
    variables, ini = folder / "rs274.var", folder / "rs274.ini"
    variables.write_text("")
    # The interpreter truncates lines of the INI file after 255 characters.
    short = []
    for index, target in enumerate(folders):
        link = folder / ("f%d" % index)
        link.unlink(missing_ok=True)
        link.symlink_to(Path(target).resolve())
        short.append(link)
    ini.write_text("[DISPLAY]\nPROGRAM_PREFIX = %s\n[RS274NGC]\nSUBROUTINE_PATH = %s\n"
                   % (program.parent, ":".join(str(f) for f in short)))
    command = [rs274, "-t", str(tools), "-v", str(variables), "-i", str(ini), "-b", "-g", str(program)]
    run = subprocess.run(command, capture_output=True, text=True, errors="replace", cwd=program.parent,
                         timeout=timeout, env=private_home(folder))
    machine = Machine()
    for line in run.stdout.splitlines():
        match = CALL.match(line)
        if match:
            machine.take(*match.groups())
    complaints = [l.strip() for l in run.stderr.splitlines() if l.strip() and l != "executing"]
    rejected = run.returncode != 0 or any("PROGRAM_END" in l for l in run.stdout.splitlines()) is False and complaints
    return machine.calls, (" / ".join(complaints) or "exit %d" % run.returncode) if rejected else None


def with_kerf(canonical_calls, program, tools, folders=()):
    """Runs Kerf's reader. Returns the calls, the error (None if it accepts) and the warnings."""
    command = [str(canonical_calls), "--tools", str(tools)]
    for folder in (program.parent, *folders):
        command += ["--folder", str(folder)]
    run = subprocess.run(command + [str(program)], capture_output=True, text=True, errors="replace", timeout=120)
    calls, error, warnings = [], None, []
    for line in run.stdout.splitlines():
        kind, _, rest = line.partition(" ")
        words = rest.split()
        if kind == "error:":
            error = rest
        elif kind == "warning:":
            warnings.append(rest)
        elif kind in ("rapid", "feed", "arc", "spline"):
            call = {"kind": kind, "line": int(words[0]), "to": [float(w) for w in words[1:7]]}
            if kind == "arc":
                call.update(plane=int(words[7]), center=[float(w) for w in words[8:10]], turns=int(words[10]))
            calls.append(call)
        elif kind == "dwell":
            calls.append({"kind": kind, "line": int(words[0]), "seconds": float(words[1])})
    if run.returncode not in (0, 1):
        error = "exit %d: %s" % (run.returncode, run.stderr.strip())
    return calls, error, warnings


def difference(ours, theirs):
    """Describes the first difference between two lists of calls; None if they agree."""
    for index, (a, b) in enumerate(zip(ours, theirs)):
        where = "call %d (line %s): " % (index + 1, a.get("line"))
        if a["kind"] != b["kind"]:
            return where + "Kerf %s, rs274 %s" % (a, b)
        if a["kind"] == "spline":
            continue
        if a["kind"] == "dwell":
            if abs(a["seconds"] - b["seconds"]) > 1e-4:
                return where + "Kerf %s, rs274 %s" % (a, b)
            continue
        if max(abs(p - q) for p, q in zip(a["to"], b["to"])) > b["tolerance"]:
            return where + "Kerf ends at %s, rs274 at %s" % (a["to"], b["to"])
        if a["kind"] == "arc":
            if a["turns"] != b["turns"] or a["plane"] != b["plane"]:
                return where + "Kerf %s, rs274 %s" % (a, b)
            if max(abs(p - q) for p, q in zip(a["center"], b["center"])) > b["tolerance"]:
                return where + "Kerf's centre is %s, rs274's %s" % (a["center"], b["center"])
    if len(ours) != len(theirs):
        return "Kerf makes %d calls, rs274 %d" % (len(ours), len(theirs))
    return None
