#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Regenerates the CSV files, the plots and the table of server/carve/tradeoff.

    tests/bench/tradeoff_tables.py [--build build/release] [--linuxcnc build/linuxcnc]
                                   [--seconds 60] [--only NAME]...

Each job is carved by `kerf-carve tradeoff` with every setting, for at most --seconds of CPU time.
The jobs with names of LinuxCNC's samples need the folder that ./test.sh unpacks. Takes some four
minutes on an otherwise idle machine; two jobs run at a time.
"""
import argparse
import concurrent.futures
import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENES = ROOT / "tests/formats/scenes"
TABLES = ROOT / "server/carve/tradeoff"
TOOLS = {
    "ball": {"id": 1, "shape": "ball", "diameter_mm": 10, "length_mm": 50},
    "flat": {"id": 1, "shape": "flat", "diameter_mm": 10, "length_mm": 50},
    "bull_nose": {"id": 1, "shape": "bull_nose", "diameter_mm": 10, "corner_radius_mm": 2,
                  "length_mm": 50},
}
# Name, title, scene, tool of the standard job or sample program, pitches, tolerances.
JOBS = [
    *((f"standard_{axes}axis_{tool}", f"standard job, {axes}-axis, {tool.replace('_', '-')} 10 mm",
       "standard", tool, "0.8,0.4,0.2,0.1" + (",0.05" if axes == 3 else ""),
       "0.1,0.01,0.001" if axes == 5 else "0.01")
      for axes in (3, 5) for tool in TOOLS),
    ("chips", "`3D_Chips.ngc`, 3-axis", "chips", "3D_Chips.ngc", "0.8,0.4,0.2,0.1", "0.01"),
    ("boat", "`boat-xyzac.ngc`, 5-axis", "boat", "boat-xyzac.ngc", "0.8,0.4,0.2,0.1",
     "0.1,0.01,0.001"),
    ("impeller", "`impeller-7bl-xyzac.ngc`, 5-axis", "impeller", "impeller-7bl-xyzac.ngc",
     "0.8,0.4,0.2,0.1", "0.1,0.01,0.001"),
]


def find(folder, name):
    found = sorted(pathlib.Path(folder).rglob(name))
    if not found:
        sys.exit(f"{name} is not below {folder}: run ./test.sh first, or name the folder with --linuxcnc")
    return found[0]


def prepare(job, options, folder):
    """Writes the scene and the program of a job; returns their files."""
    name, _, scene, source, _, _ = job
    if source not in TOOLS:
        return SCENES / f"{scene}.json", find(options.linuxcnc, source)
    scene_file, program = folder / f"{name}.json", folder / f"{name}.apt"
    with open(SCENES / f"{scene}.json") as file:
        described = json.load(file)
    described["tools"] = [TOOLS[source]]
    scene_file.write_text(json.dumps(described))
    axes = "5" if "_5axis_" in name else "3"
    with open(program, "w") as file:
        subprocess.run([options.build / "tests/bench/standard_program", axes], stdout=file,
                       check=True)
    return scene_file, program


def run(job, options, folder):
    name, _, _, _, pitches, tolerances = job
    scene, program = prepare(job, options, folder)
    done = subprocess.run(
        [options.build / "bin/kerf-carve", "tradeoff", "--scene", scene, "--program", program,
         "--pitches", pitches, "--tolerances", tolerances, "--samples", "3000",
         "--budget-seconds", str(options.seconds), "--csv", TABLES / f"{name}.csv", "--svg",
         TABLES / f"{name}.svg"], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{name}: {done.stderr}")
    print(f"{name}: done", flush=True)


def table_row(job):
    """The row of a job in the README. The CSV has every configuration."""
    name, title = job[:2]
    with open(TABLES / f"{name}.csv") as file:
        rows = list(csv.DictReader(file))
    skipped = sum(1 for row in rows if row["skipped"])
    return f"| {title} | [plot]({name}.svg), [CSV]({name}.csv) | {skipped} of {len(rows)} |\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--linuxcnc", type=pathlib.Path, default=ROOT / "build/linuxcnc")
    parser.add_argument("--seconds", type=int, default=60)
    parser.add_argument("--only", action="append", default=[])
    options = parser.parse_args()
    jobs = [job for job in JOBS if not options.only or job[0] in options.only]
    with tempfile.TemporaryDirectory() as folder:
        with concurrent.futures.ThreadPoolExecutor(max_workers=min(2, os.cpu_count())) as pool:
            list(pool.map(lambda job: run(job, options, pathlib.Path(folder)), jobs))
    rows = "".join(table_row(job) for job in JOBS if (TABLES / f"{job[0]}.csv").exists())
    readme = TABLES / "README.md"
    head = readme.read_text().split("\n|")[0].rstrip()
    readme.write_text(head + "\n\n| job | results | over the budget |\n|---|---|---|\n" + rows)


if __name__ == "__main__":
    main()
