# SPDX-License-Identifier: Apache-2.0
"""Where the time of test.sh went: the slowest tests of each group, and CPU seconds of build and tests."""
import json
import pathlib
import xml.etree.ElementTree as ElementTree

SLOWEST = 10
NAME_LETTERS = 86  # so that a line has 100


def times_of(path):
    """(seconds, name) of each test of a group: ctest's JUnit file, or vitest's JSON file."""
    if path.suffix == ".xml":
        cases = ElementTree.parse(path).getroot().iter("testcase")
        return [(float(case.get("time") or 0), case.get("name")) for case in cases]
    times = []
    for suite in json.loads(path.read_text()).get("testResults", []):
        file = pathlib.Path(suite["name"]).name
        for test in suite["assertionResults"]:
            times.append(((test.get("duration") or 0) / 1000, f'{file}: {test["fullName"].strip()}'))
    return times


def cpu_seconds(folder):
    """CPU seconds by what took them, of the file that test.sh writes: `NAME SECONDS` a line."""
    file = folder / "cpu.txt"
    if not file.exists():
        return []
    return [(name, float(seconds)) for name, seconds in map(str.split, file.read_text().splitlines())]


def report(folder):
    """Lines that tell where the time went, of a folder of results."""
    lines = []
    for path in [*sorted(folder.glob("ctest-*.xml")), *folder.glob("vitest.json")]:
        times = sorted(times_of(path), reverse=True)
        if not times:
            continue
        group = path.stem.removeprefix("ctest-").replace("vitest", "web")
        total = sum(seconds for seconds, _ in times)
        lines.append(f"Slowest of {group}: {len(times)} tests, {total:.1f} s in all")
        lines += [f"{seconds:9.2f} s  {name[:NAME_LETTERS]}" for seconds, name in times[:SLOWEST]]
    spent = cpu_seconds(folder)
    if spent:
        parts = ", ".join(f"{name} {seconds:.0f} s" for name, seconds in spent)
        lines.append(f"CPU time of the programs that have ended: {parts}")
    return lines
