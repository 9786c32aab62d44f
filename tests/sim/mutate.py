# SPDX-License-Identifier: Apache-2.0
"""mutate.py BUILD [--first SEED] [--seeds N] [--only TEXT]: plants each fault of mutations.py in a copy of its source
file, builds `sim` with it elsewhere, and runs worlds until one fails. Prints the seed and the CPU time.
Exit 1: a fault was not found, or does not fit its source any more."""
import argparse
import os
import re
import shlex
import subprocess
import sys
import tempfile
import time

from mutations import MUTATIONS

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


def commands(build):
    """The commands that compile and link `sim`, the link last."""
    run = subprocess.run(["ninja", "-C", build, "-t", "commands", "sim"], check=True, capture_output=True, text=True)
    return run.stdout.splitlines()


def mutated_source(mutation, folder):
    """Writes the source with the fault; returns its path."""
    with open(os.path.join(ROOT, mutation.file)) as file:
        text = file.read()
    if text.count(mutation.text) != 1:
        raise ValueError(f"its text occurs {text.count(mutation.text)} times in {mutation.file}")
    path = os.path.join(folder, os.path.basename(mutation.file))
    with open(path, "w") as file:
        file.write(text.replace(mutation.text, mutation.mutated))
    return path


def unit_of(mutation, lines):
    """The command of the unit that compiles the file, and the unit's source: itself, or several together."""
    source = os.path.join(ROOT, mutation.file)
    for line in lines:
        found = re.search(r" -c (\S+)", line)
        if not found:
            continue
        unit = found.group(1)
        if unit == source:
            return line, unit
        if unit.endswith(".cxx") and os.path.exists(unit):
            with open(unit) as file:
                if f'"{source}"' in file.read():
                    return line, unit
    raise ValueError(f"no unit of sim compiles {mutation.file}")


def build_with(mutation, build, lines, folder):
    """Builds a `sim` with the fault; returns its path. Its object comes before the library that has the other."""
    line, unit = unit_of(mutation, lines)
    path = mutated_source(mutation, folder)
    if unit.endswith(".cxx"):
        with open(unit) as file:
            together = file.read().replace(f'"{os.path.join(ROOT, mutation.file)}"', f'"{path}"')
        path = os.path.join(folder, "unit.cxx")
        with open(path, "w") as file:
            file.write(together)
    words = shlex.split(line)
    words = [word for word in words if word != "ccache"]
    object_file = os.path.join(folder, "mutated.o")
    words[words.index("-o") + 1] = object_file
    words[words.index("-c") + 1] = path
    for flag in ("-MF", "-MT"):
        words[words.index(flag) + 1] = os.path.join(folder, "ignored")
    subprocess.run([*words, "-w", "-Wno-error"], cwd=build, check=True)
    program = os.path.join(folder, "sim")
    link = next(line for line in reversed(lines) if " -o tests/sim/sim " in line)
    link = link.replace(" -o tests/sim/sim ", f" {object_file} -o {program} ", 1)
    subprocess.run(link, cwd=build, check=True, shell=True)
    return program


def faults(program, seed, folder):
    """The sentences with which a world fails; none: it is good."""
    run = subprocess.run([program, "--seed", str(seed), "--folder", os.path.join(folder, "worlds")],
                         capture_output=True, text=True)
    if run.returncode == 0:
        return []
    return [line for line in run.stdout.splitlines()
            if line and not line.startswith(("seed ", "  fault", "again:", "1 worlds"))
            and " of CPU, " not in line] or ["it failed"]


def hunt(program, sound, seeds, folder):
    """Runs worlds until one fails that is good with the program `sound`: its seed and the first sentence."""
    for seed in seeds:
        sentences = faults(program, seed, folder)
        if sentences and not faults(sound, seed, folder):
            return seed, sentences[0]
    return None


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build")
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--seeds", type=int, default=3000)
    parser.add_argument("--only", default="")
    options = parser.parse_args()
    lines = commands(options.build)
    failed = 0
    for mutation in MUTATIONS:
        if options.only not in mutation.name:
            continue
        with tempfile.TemporaryDirectory(prefix="kerf-mutation-") as folder:
            try:
                program = build_with(mutation, options.build, lines, folder)
            except ValueError as error:
                print(f"{mutation.name}: {error}")
                failed += 1
                continue
            before = os.times()
            start = time.monotonic()
            sound = os.path.join(options.build, "tests", "sim", "sim")
            found = hunt(program, sound, range(options.first, options.first + options.seeds), folder)
            after = os.times()
            cpu = after.children_user + after.children_system - before.children_user - before.children_system
            if found is None:
                failed += 1
                print(f"{mutation.name}: NOT found in {options.seeds} worlds, {cpu:.0f} s of CPU", flush=True)
            else:
                print(f"{mutation.name}: seed {found[0]}, {cpu:.1f} s of CPU, {time.monotonic() - start:.0f} s: "
                      f"{found[1][:110]}", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
