#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""build_cost.py BUILD CHANGELOG: the compiler reads no more than a tenth above what the changelog states.

Prints the megabytes of source that each unit of the folder BUILD includes, precompiled headers left out, the ten largest
units and the sum. CPU seconds of a build differ by half between two runs; this sum, which grows with them, does not differ.
Exit 1: the sum is more than a tenth above the first "reads N MB of source" of CHANGELOG.
"""
import json
import pathlib
import re
import subprocess
import sys

GROWTH = 1.1
LARGEST = 10
STATED = re.compile(r"reads\s+(\d+)\s+MB\s+of\s+source")


def units_of(build):
    """The object files that the build makes, by their paths in its folder."""
    commands = json.loads((build / "compile_commands.json").read_text())
    return {command["command"].split(" -o ")[1].split()[0] for command in commands}


def included_by_unit(listing):
    """The files that each unit includes, of the output of `ninja -t deps`."""
    included, unit = {}, None
    for line in listing.splitlines():
        if line.startswith(" "):
            included[unit].append(line.strip())
        elif line:
            unit = line.split(":")[0]
            included[unit] = []
    return included


def megabytes(build, files):
    paths = (build / file for file in files if not file.endswith((".gch", ".pch")))
    return sum(path.stat().st_size for path in paths if path.exists()) / 1e6


def costs(build):
    """Megabytes by unit."""
    listing = subprocess.run(["ninja", "-C", build, "-t", "deps"], check=True, capture_output=True, text=True).stdout
    units = units_of(build)
    return {unit: megabytes(build, files) for unit, files in included_by_unit(listing).items() if unit in units}


def stated_in(changelog):
    found = STATED.search(changelog)
    if not found:
        sys.exit('The changelog does not state how much a build reads: "reads N MB of source".')
    return int(found[1])


def fault(total, stated):
    """What is wrong with a build that reads `total` MB, or an empty string."""
    if total <= GROWTH * stated:
        return ""
    return (f"The compiler reads {total:.0f} MB of source, more than a tenth above the {stated} MB of CHANGELOG.md: include "
            "less, or precompile or group what is included most (CMakeLists.txt). If it is worth it, state there why, and the sum.")


def main():
    build, changelog = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    by_unit = costs(build)
    for unit, cost in sorted(by_unit.items(), key=lambda item: -item[1])[:LARGEST]:
        print(f"{cost:8.1f} MB  {unit}")
    total = sum(by_unit.values())
    print(f"{total:8.1f} MB  in {len(by_unit)} units")
    sys.exit(fault(total, stated_in(changelog.read_text())) or 0)


if __name__ == "__main__":
    main()
