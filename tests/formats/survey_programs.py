#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Carves every program below a folder and prints a table: per dialect, how many were tried, carved,
rightly and wrongly refused.

An error is judged by a person, in a text file of lines "PATH<TAB>right|wrong<TAB>why", PATH
relative to the folder. What it does not name counts as "not judged" and is listed with its error,
so that the list can become the file:

    survey_programs.py build/release/bin/kerf-carve programs/ --judged judged.tsv
"""
import argparse
import collections
import concurrent.futures
import pathlib
import re
import subprocess
import sys

EXTENSIONS = {
    "nc", "ngc", "tap", "mpf", "spf", "h", "apt", "cl", "cls", "cnc", "gcode", "eia", "min", "pim",
    "txt", "ptp", "ncc", "fnc", "iso", "cldata", "ncl", "aptsource"
}
COLUMNS = ["carved", "right", "wrong", "not judged"]


def carve(program, path, seconds):
    """Returns whether a program is carved, its dialect and the error."""
    command = [program, str(path), "--wall-samples", "0", "--threads", "1", "--pitch", "2"]
    try:
        run = subprocess.run(command, capture_output=True, text=True, errors="replace",
                             timeout=seconds, check=False)
    except subprocess.TimeoutExpired:
        return False, "not known", f"takes more than {seconds} s"
    lines = [line for line in run.stderr.splitlines() if line.strip()]
    said = re.search(r"read as ([A-Za-z]+)", run.stderr)
    dialect = said.group(1) if said else "LinuxCNC"
    errors = [line for line in lines if not line.startswith(("warning", "scene"))]
    return run.returncode == 0, dialect, errors[-1] if errors else ""


def judgements(path):
    """Reads the judged errors."""
    judged = {}
    for number, line in enumerate(path.read_text().splitlines() if path else [], 1):
        if not line.strip() or line.startswith("#"):
            continue
        parts = line.split("\t")
        if len(parts) < 2 or parts[1] not in ("right", "wrong"):
            sys.exit(f"{path}:{number}: must be PATH, a tab, 'right' or 'wrong', a tab, and why")
        judged[parts[0]] = parts[1]
    return judged


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kerf_carve")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--judged", type=pathlib.Path)
    parser.add_argument("--seconds", type=int, default=120, help="limit of one program")
    parser.add_argument("--jobs", type=int, default=1)
    options = parser.parse_args()
    judged = judgements(options.judged)
    files = sorted(path for path in options.folder.rglob("*")
                   if path.is_file() and path.suffix[1:].lower() in EXTENSIONS)
    if not files:
        sys.exit(f"no program below {options.folder}")
    table = collections.defaultdict(collections.Counter)
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        results = pool.map(lambda path: carve(options.kerf_carve, path, options.seconds), files)
        for path, (carved, dialect, error) in zip(files, results):
            name = str(path.relative_to(options.folder))
            kind = "carved" if carved else judged.get(name, "not judged")
            table[dialect][kind] += 1
            if kind == "not judged":
                print(f"{name}\t\t{error}")
    print("\n| read as | tried | carved | rightly refused | wrongly refused | not judged |")
    print("|---|---|---|---|---|---|")
    total = collections.Counter()
    for dialect in sorted(table):
        total.update(table[dialect])
        row = [sum(table[dialect].values())] + [table[dialect][column] for column in COLUMNS]
        print(f"| {dialect} | " + " | ".join(map(str, row)) + " |")
    print("| all | " + " | ".join(map(str, [len(files)] + [total[c] for c in COLUMNS])) + " |")
    taken = total["carved"] + total["wrong"]
    if taken:
        print(f"\n{100 * total['carved'] / taken:.1f} % of those that a control takes are carved")


if __name__ == "__main__":
    main()
