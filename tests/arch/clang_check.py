# SPDX-License-Identifier: Apache-2.0
"""clang_check.py SOURCE BUILD [--tests]: checks every C++ unit of the libraries and programs, and with
--tests those of tests and benches, with clang++-19, warnings as errors, without generating code.
Configures its own folder BUILD; precompiled headers and shared units save time. Exit 77: clang++-19
is not installed."""
import concurrent.futures
import json
import os
import shlex
import shutil
import subprocess
import sys

SKIPPED = 77


def configure(source, build, tests):
    options = ["-DCMAKE_CXX_COMPILER=clang++-19", "-DCMAKE_BUILD_TYPE=Debug", "-DKERF_WERROR=ON",
               "-DKERF_FAST_BUILD=ON", f"-DKERF_TESTS={tests}"]
    subprocess.run(["cmake", "-S", source, "-B", build, "-G", "Ninja", *options], check=True, stdout=subprocess.DEVNULL)
    targets = subprocess.run(["ninja", "-C", build, "-t", "targets", "all"], check=True, capture_output=True, text=True)
    precompiled = [line.split(": ")[0] for line in targets.stdout.splitlines() if line.split(": ")[0].endswith(".pch")]
    subprocess.run(["ninja", "-C", build, "--quiet", *precompiled], check=True)


def check(unit):
    """Returns the exit code and the messages of one unit's compilation."""
    words = [word for word in shlex.split(unit["command"]) if word != "-c"]
    output = words.index("-o")
    del words[output:output + 2]
    run = subprocess.run([*words, "-fsyntax-only"], cwd=unit["directory"], capture_output=True, text=True)
    return run.returncode, run.stderr


def main():
    if shutil.which("clang++-19") is None:
        print("skipped: clang++-19 is not installed")
        return SKIPPED
    source, build = sys.argv[1:3]
    configure(source, build, "ON" if "--tests" in sys.argv[3:] else "OFF")
    with open(os.path.join(build, "compile_commands.json")) as file:
        units = [unit for unit in json.load(file) if ".pch" not in unit["command"].split(" -o ")[1].split()[0]]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        results = list(pool.map(check, units))
    for _, messages in results:
        print(messages, end="")
    failed = sum(code != 0 for code, _ in results)
    print(f"clang++-19: {len(units)} units, {failed} with warnings or errors")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
