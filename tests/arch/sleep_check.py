# SPDX-License-Identifier: Apache-2.0
"""sleep_check.py SOURCE: refuses sleeps in tests that sleep_table.py does not list with a reason.

A test that sleeps is slow on a quick machine and fails on a slow one. It waits for what it needs,
with `eventually` of C++ and Python or `until` of the e2e tests. What the table lists and no file has
any more is refused too, so that it stays an inventory. Benches are no tests, and in tests/sim time is
virtual: a sleep there costs nothing and ends at the same moment on every machine."""
import collections
import pathlib
import re
import sys

from sleep_table import KINDS, SLEEPS

FOLDERS = ("tests", "web/test")
SKIPPED = ("tests/bench/", "tests/arch/", "tests/sim/")
BENCHES = ("_bench.mjs",)
CALLS = {
    (".h", ".cpp"): r"\b(?:sleep_for|sleep_until|usleep|nanosleep|clock_nanosleep|sleep)\s*\(",
    (".py",): r"\bsleep\s*\(|\bselect\(\s*\[\],\s*\[\],\s*\[\]\s*,",
    (".ts", ".mjs"): r"\bsetTimeout\s*\(|\bwaitForTimeout\s*\(|\bscheduler\.wait\s*\(",
    (".sh",): r"(?:^|[;&|]|\bdo\b|\bthen\b)\s*sleep\s",
}
COMMENT = {".h": "//", ".cpp": "//", ".ts": "//", ".mjs": "//", ".py": "#", ".sh": "#"}


def sleeps_in(name, text):
    """Lines of a file that sleep, from 1."""
    suffix = pathlib.PurePath(name).suffix
    for suffixes, call in CALLS.items():
        if suffix in suffixes:
            lines = (line.split(COMMENT[suffix])[0] for line in text.splitlines())
            return [n for n, line in enumerate(lines, 1) if re.search(call, line)]
    return []


def found_in(source):
    """Lines that sleep, of each file below a source tree that has any."""
    found = {}
    for folder in FOLDERS:
        for path in sorted((source / folder).rglob("*")):
            name = path.relative_to(source).as_posix()
            if "node_modules" in path.parts or not path.is_file():
                continue
            if name.startswith(SKIPPED) or name.endswith(BENCHES):
                continue
            if path.suffix in COMMENT and (lines := sleeps_in(name, path.read_text())):
                found[name] = lines
    return found


def violations(found, table):
    """What is wrong with the sleeps that were found, one text each."""
    wrong = []
    listed = {}
    for name, count, kind, reason in table:
        if name in listed:
            wrong.append(f"{name}: has two rows of sleep_table.py: one row tells all")
        if kind not in KINDS or not reason:
            wrong.append(f"{name}: its row of sleep_table.py needs a kind of KINDS and a reason")
        listed[name] = count
    for name in sorted(set(found) | set(listed)):
        lines, count = found.get(name, []), listed.get(name, 0)
        if len(lines) > count:
            wrong.append(f"{name}:{lines[-1]}: sleeps in {len(lines)} lines, {count} are listed: "
                         "wait for the event itself, or ask until it is there (`eventually`, "
                         "`until`)")
        elif len(lines) < count:
            wrong.append(f"{name}: sleeps in {len(lines)} lines, {count} are listed: lower the "
                         "count of sleep_table.py, or take out the row")
    return wrong


def main():
    wrong = violations(found_in(pathlib.Path(sys.argv[1])), SLEEPS)
    for text in wrong:
        print(text)
    counts = collections.Counter()
    for _, count, kind, _ in SLEEPS:
        counts[kind] += count
    parts = ", ".join(f"{counts[kind]} {kind}" for kind in KINDS)
    print(f"{sum(counts.values())} sleeps of tests are listed: {parts}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
