#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Sums the results that test.sh wrote to a folder and prints `N passed, M failed` as its last line.

A GoogleTest program counts by its cases (its own XML in gtest/), any other ctest entry as one case, vitest by its cases.
Before that line stand where the time went (time_spent.py), what was skipped and what failed, with the folder in which
logs and screenshots of it are, if it left any. Exit status 1 if anything failed or nothing ran.
"""

import json
import pathlib
import sys
import xml.etree.ElementTree as ElementTree

from time_spent import report


def gtest_counts(path):
    """(passed, failed, skipped with their reasons) of one GoogleTest program."""
    passed, failed, skipped = 0, [], []
    for case in ElementTree.parse(path).getroot().iter("testcase"):
        name = f'{case.get("classname")}.{case.get("name")}'
        skip = case.find("skipped")
        if case.find("failure") is not None:
            failed.append(name)
        elif skip is not None:
            reason = (skip.get("message") or skip.text or "no reason given").strip()
            skipped.append(f"{name}: {reason.splitlines()[-1]}")
        elif case.get("status") == "run":
            passed += 1
    return passed, failed, skipped


def skipped_on_purpose(case):
    """ctest also calls a program that it cannot find "skipped"; that one failed."""
    skip = case.find("skipped")
    return skip is not None and (skip.get("message") or "").startswith(("SKIP_", "Disabled"))


def reason_printed(case):
    """What the program said after "skipped: ", or else ctest's own words."""
    for line in (case.findtext("system-out") or "").splitlines():
        if line.startswith("skipped: "):
            return line.removeprefix("skipped: ")
    return case.find("skipped").get("message")


def vitest_counts(path):
    """(passed, failed) of the viewer's own tests, failed ones by file, name and the first line of the message."""
    result = json.loads(path.read_text())
    failed = []
    for suite in result.get("testResults", []):
        file = pathlib.Path(suite["name"]).name
        bad = [test for test in suite["assertionResults"] if test["status"] == "failed"]
        for test in bad:
            message = (test.get("failureMessages") or [""])[0].strip().split("\n")[0]
            failed.append(f'web: {file}: {test["fullName"].strip()}: {message[:200]}')
        if suite["status"] == "failed" and not bad:
            failed.append(f"web: {file}: the file could not be loaded")
    if not failed and not result.get("success", False):
        failed.append("web: vitest itself failed")
    return result["numPassedTests"], failed


def collect(folder):
    passed, failed, skipped = 0, [], []
    for path in sorted(folder.glob("ctest-*.xml")):
        for case in ElementTree.parse(path).getroot().iter("testcase"):
            name = case.get("name")
            own = folder / "gtest" / f"{name}.xml"
            ok = case.get("status") == "run"
            if own.exists():
                p, f, s = gtest_counts(own)
                passed, failed, skipped = passed + p, failed + [f"{name}: {x}" for x in f], skipped + s
                if not ok and not f:  # its cases passed, yet it ended badly: a crash at exit, a sanitizer's report
                    failed.append(f"{name}: ended badly after its tests")
            elif ok:
                passed += 1
            elif skipped_on_purpose(case):
                skipped.append(f"{name}: {reason_printed(case)}")
            else:
                failed.append(name)
    vitest = folder / "vitest.json"
    if vitest.exists():
        p, f = vitest_counts(vitest)
        passed, failed = passed + p, failed + f
    return passed, failed, skipped


def left_by(failed, results):
    """Where a failed ctest entry has left its logs; None: it has left none."""
    folder = results.parent / "failed" / failed.split(":")[0]
    return folder if folder.is_dir() else None


def main():
    results = pathlib.Path(sys.argv[1])
    passed, failed, skipped = collect(results)
    for line in report(results):
        print(line)
    for line in skipped:
        print(f"skipped  {line}")
    for line in failed:
        folder = left_by(line, results)
        print(f"FAILED   {line}" + (f" (logs: {folder})" if folder else ""))
    print(f"{passed} passed, {len(failed)} failed")
    sys.exit(1 if failed or not passed else 0)


if __name__ == "__main__":
    main()
