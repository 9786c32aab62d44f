#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Reads every sample program of LinuxCNC with Kerf and with rs274, compares every canonical call and prints a table.

usage: compare_samples.py CANONICAL_CALLS [--linuxcnc DIR] [--list]
DIR is the folder that test.sh unpacks LinuxCNC to; it contains rs274 and root/. Exit status: 77 (skipped) if DIR is
missing; 1 if the two disagree on a program, or if Kerf rejects a program that rs274 accepts and the reason is not in
REASONS.
"""
import argparse
import collections
import os
import re
import sys
import tempfile
from pathlib import Path

import rs274 as reference

# Known reasons for which Kerf rejects a program that LinuxCNC reads: part of Kerf's message and its
# meaning.
REASONS = {
    "is a probing move": "probing: the contact point is known on a machine only",
    "is a lathe code": "lathe cycles",
    "constant surface speed (G96) is for lathes": "lathe cycles",
    "spindle-synchronized threading": "lathe threads",
}
# Known reasons for which the stand-alone rs274 rejects a program that Kerf reads: part of its
# message.
THEIR_REASONS = {
    "File ended with no percent sign": "no M2, M30 or %: Kerf warns, rs274 rejects (subroutines, for the most part)",
    "M-code greater than 199": "M428, M429: remapped by the sample machines' configurations",
}
SUBROUTINES = ["", "ngcgui_lib", "ngcgui_lib/utilitysubs", "gladevcp_lib", "remap_lib/common_nc_subs"]


def table(lengths):
    """Returns a tool table in inches, the unit of rs274, with or without tool lengths."""
    return "".join("T%d P%d %sD%.4f\n" % (n, n, "Z%.3f " % (n / 8) if lengths else "", 0.12 + 0.02 * (n % 12))
                   for n in [*range(1, 21), 99, 100])


def reason_in(text, reasons):
    """Returns the meaning of the first of `reasons` that is part of a message; None if there is none."""
    return next((why for part, why in reasons.items() if part in text), None)


class Comparison:
    """Compares programs of LinuxCNC's package one by one."""

    def __init__(self, canonical_calls, linuxcnc, folder):
        self.canonical_calls, self.folder = canonical_calls, folder
        self.rs274 = reference.with_nine_decimals(linuxcnc / "rs274", folder)
        nc_files = linuxcnc / "root/usr/share/linuxcnc/ncfiles"
        self.subroutines = [nc_files / s for s in SUBROUTINES]
        self.tools = {}
        for lengths in (True, False):
            self.tools[lengths] = folder / ("long.tbl" if lengths else "flat.tbl")
            self.tools[lengths].write_text(table(lengths))

    def compare(self, program, lengths=True):
        tools = self.tools[lengths]
        theirs, complaint = reference.with_rs274(self.rs274, program, self.folder, tools, self.subroutines)
        ours, error, _ = reference.with_kerf(self.canonical_calls, program, tools, self.subroutines)
        if complaint is None and error is None:
            return ours, theirs, None, None, reference.difference(ours, theirs)
        return ours, theirs, complaint, error, None

    def judge(self, program):
        """Returns the category ("agree", "both reject", …, "wrong: …"), the number of equal calls and a message."""
        ours, theirs, complaint, error, differs = self.compare(program)
        if differs:
            # The stand-alone rs274 loses the offset of a G43 in the same block as an M6.
            flat = self.compare(program, lengths=False)
            if flat[4] is None and flat[2] is None and flat[3] is None:
                return "agree, but for lengths that rs274 forgets after M6", len(ours), ""
            return "wrong: they disagree", len(ours), differs
        if complaint is None and error is None:
            moves = any(c["kind"] != "dwell" for c in ours)
            return "agree" if moves else "agree: nothing moves", len(ours), ""
        if complaint is None:
            why = reason_in(error, REASONS)
            return ("Kerf rejects: " + why if why else "wrong: Kerf rejects without a stated reason"), 0, error
        if error is None:
            why = reason_in(complaint, THEIR_REASONS)
            if "program end" in complaint and (differs := reference.difference(ours, theirs)):
                return "wrong: they disagree", 0, differs
            return ("rs274 rejects: " + why if why else "wrong: only rs274 rejects"), 0, complaint
        return "both reject", 0, error


def caller_of(program, folder):
    """Writes a program that calls the subroutine in a file with the arguments that its comments propose.

    Returns its path, or None if the file defines no subroutine of its name.
    """
    text = program.read_text(errors="replace")
    if not re.search(r"^\s*o<%s>\s*sub" % re.escape(program.stem), text, re.I | re.M):
        return None
    values = {int(n): v for n, v in re.findall(r"=\s*#(\d+)\s*\(\s*=\s*(-?[\d.]+)", text) if int(n) <= 30}
    arguments = " ".join("[%s]" % values.get(n, n) for n in range(1, max(values, default=5) + 1))
    caller = folder / "caller.ngc"
    caller.write_text("G20 G17 G90 G40 G49 G80 G94 F20\nT4 M6\nS800 M3\nG0 X0.1 Y0.2 Z2\no<%s> call %s\nM2\n"
                      % (program.stem, arguments))
    return caller


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("canonical_calls", type=Path)
    parser.add_argument("--linuxcnc", default=os.environ.get("KERF_LINUXCNC_DIR"))
    parser.add_argument("--list", action="store_true", help="one line for each program")
    args = parser.parse_args()
    if not args.linuxcnc or not (Path(args.linuxcnc) / "rs274").exists():
        print("skipped: LinuxCNC's package is missing; set KERF_LINUXCNC_DIR")
        return 77
    linuxcnc = Path(args.linuxcnc).resolve()
    share = linuxcnc / "root/usr/share"
    programs = sorted(p for p in share.rglob("*") if p.suffix.lower() in (".ngc", ".nc", ".tap") and p.is_file())
    count, called, calls, wrong = collections.Counter(), collections.Counter(), 0, []
    with tempfile.TemporaryDirectory() as name:
        comparison = Comparison(args.canonical_calls.resolve(), linuxcnc, Path(name))
        for program in programs:
            category, equal, text = comparison.judge(program)
            count[category] += 1
            calls += equal if category.startswith("agree") else 0
            line = "%s: %s %s" % (program.relative_to(share), category, text.replace(str(share) + "/", ""))
            if category.startswith(("wrong", "Kerf rejects")) or args.list:
                print(line)
            if category.startswith("wrong"):
                wrong.append(line)
            caller = caller_of(program, comparison.folder)
            if caller:
                comparison.subroutines.insert(0, program.parent)
                category, equal, text = comparison.judge(caller)
                comparison.subroutines.pop(0)
                called[category] += 1
                calls += equal if category.startswith("agree") else 0
                line = "%s, called: %s %s" % (program.relative_to(share), category, text.replace(str(share) + "/", ""))
                if category.startswith("wrong") or args.list:
                    print(line)
                if category.startswith("wrong"):
                    wrong.append(line)
    for title, table_of in (("programs", count), ("subroutines among them, called by a generated program", called)):
        print("%d %s:" % (sum(table_of.values()), title))
        for category, number in sorted(table_of.items()):
            print("%6d  %s" % (number, category))
    print("%d programs, %d canonical calls equal, %d wrong" % (len(programs), calls, len(wrong)))
    return 1 if wrong or not programs else 0


sys.exit(main())
