#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Builds the kernel and state_hashes with another compiler, optimization level or instruction set, or as WebAssembly, and
compares its output byte for byte with that of the reference state_hashes. With --program, compares another program, which is
already built; with --threads, the reference with itself on several threads.

Exit status: 0 equal; 1 different, or the build failed; 77 this machine cannot run that build (the reason is printed).
"""

import argparse
import os
import pathlib
import shutil
import subprocess
import sys

CANNOT_RUN = 77
SOURCES = pathlib.Path(__file__).resolve().parents[2]
# CPU features that x86-64-v3 and x86-64-v4 require, as named in /proc/cpuinfo.
V3 = {"avx2", "fma", "bmi2"}
V4 = {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"}
WASI_HEADERS = pathlib.Path("/usr/include/wasm32-wasi/c++/v1")


def arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--compiler")
    parser.add_argument("--wasm", action="store_true",
                        help="build with the preset of kerf.wasm, whose kernel is then compiled once, and run it in node")
    parser.add_argument("--flags", help="compiler flags, e.g. -O2")
    parser.add_argument("--folder", type=pathlib.Path, help="where to build")
    parser.add_argument("--program", type=pathlib.Path, help="compare this one; builds nothing")
    parser.add_argument("--level", choices=["v1", "v3", "v4"], default="v1", help="what the CPU must have: x86-64-v3, -v4")
    parser.add_argument("--every", type=int, default=1, help="compare each N-th job only, where the build is slow")
    parser.add_argument("--threads", type=int, nargs="+", help="numbers of threads to compare with one; builds nothing")
    parser.add_argument("--reference", required=True, type=pathlib.Path, help="state_hashes program to compare with")
    return parser.parse_args()


def why_not(options):
    """Returns why this machine cannot run the build, or an empty string."""
    tools = ["clang++-19", "wasm-ld-19", "node"] if options.wasm else [options.compiler] if options.compiler else []
    absent = [tool for tool in tools if shutil.which(tool) is None]
    if options.wasm and not WASI_HEADERS.is_dir():
        absent.append("libc++-19-dev-wasm32")
    if absent:
        return f"{', '.join(absent)}: not installed"
    needs = {"v1": set(), "v3": V3, "v4": V3 | V4}[options.level]
    missing = needs - set(pathlib.Path("/proc/cpuinfo").read_text().split())
    return f"this CPU has no {', '.join(sorted(missing))}" if missing else ""


def build(options):
    """Builds state_hashes; returns how to run it."""
    # Ignore the environment's compiler and flags: this build sets its own.
    environment = {k: v for k, v in os.environ.items() if k not in ("CXX", "CXXFLAGS", "CC", "CFLAGS")}
    # Not an option: one that differs from that of an earlier build would recompile everything.
    if "CMAKE_CXX_COMPILER_LAUNCHER" not in environment and shutil.which("ccache"):
        environment["CMAKE_CXX_COMPILER_LAUNCHER"] = "ccache"
    folder = SOURCES / "build/wasm" if options.wasm else options.folder
    if options.wasm:
        configure = ["cmake", "--preset", "wasm", "-DKERF_TESTS=ON"]
    else:
        configure = ["cmake", "-G", "Ninja", "-S", SOURCES, "-B", folder, "-DKERF_KERNEL_ONLY=ON",
                     f"-DCMAKE_CXX_COMPILER={options.compiler}", f"-DCMAKE_CXX_FLAGS={options.flags}",
                     "-DKERF_VECTOR=none", "-DKERF_FAST_BUILD=ON"]
    # One job, because ctest runs several of these builds at a time.
    for command in (configure, ["cmake", "--build", folder, "--target", "state_hashes", "-j", "1"]):
        done = subprocess.run(command, cwd=SOURCES, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if done.returncode != 0:
            sys.exit(f"{done.stdout}\nThis build failed: {' '.join(map(str, command))}")
    program = folder / "tests/determinism/state_hashes"
    if options.wasm:
        return ["node", "--no-warnings", SOURCES / "tests/determinism/run_wasi.mjs", f"{program}.wasm"]
    return [program]


def printed_by(program, *arguments):
    return subprocess.run([program, *arguments], check=True, stdout=subprocess.PIPE).stdout


def compare(expected, seen):
    if seen == expected:
        print(f"{len(expected.splitlines())} jobs give equal bytes")
        return
    for a, b in zip(expected.splitlines(), seen.splitlines()):
        if a != b:
            print(f"expected  {a.decode()}\nseen      {b.decode()}")
    sys.exit("The two do not agree.")


def main():
    options = arguments()
    if options.threads:
        for threads in options.threads:
            compare(printed_by(options.reference), printed_by(options.reference, str(threads)))
        return
    reason = why_not(options)
    if reason:
        print(f"skipped: {reason}")
        sys.exit(CANNOT_RUN)
    program = [options.program] if options.program else build(options)
    jobs = ("1", str(options.every))
    compare(printed_by(options.reference, *jobs), printed_by(*program, *jobs))


main()
