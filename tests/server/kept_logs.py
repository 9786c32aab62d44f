# SPDX-License-Identifier: Apache-2.0
"""What a test leaves to be looked at if it fails: what the programs wrote that it has started.

It is written while the test runs, because ctest kills a program that takes too long, and is removed
when the test has passed. The folder is $KERF_FAILED, with one below it for each case.
"""
import atexit
import contextlib
import itertools
import os
import re
import shutil
import sys
import tempfile
import threading
import unittest

FOLDER = os.environ.get("KERF_FAILED") or os.path.join(
    tempfile.gettempdir(), "kerf-failed", os.path.basename(sys.argv[0]).removesuffix("_test.py"))
_case = FOLDER  # log folder of the running case
_number = itertools.count(1)


def path_of(name):
    """A new file for what a program writes."""
    os.makedirs(_case, exist_ok=True)
    return os.path.join(_case, f"{next(_number):02}-{name}.log")


def keep(name, text):
    """Keeps what a program wrote, and returns it."""
    # The test may have limited its file size.
    with contextlib.suppress(OSError), open(path_of(name), "w", encoding="utf-8") as file:
        file.write(text)
    return text


class Output(threading.Thread):
    """Reads what a program writes until it ends, so that it never waits, and keeps it."""

    def __init__(self, pipe, name):
        super().__init__(daemon=True)
        self._pipe, self._path = pipe, path_of(name)
        self._lines, self._seen, self._has_ended = [], 0, False
        self._changed = threading.Condition()
        self.start()

    def run(self):
        with self._pipe:
            for line in self._pipe:
                with self._changed:
                    self._lines.append(line)
                    self._changed.notify_all()
                with contextlib.suppress(OSError), open(self._path, "a", encoding="utf-8") as file:
                    file.write(line)
        with self._changed:
            self._has_ended = True
            self._changed.notify_all()

    def so_far(self):
        with self._changed:
            return "".join(self._lines)

    def whole(self):
        """All of it, once the program has ended."""
        self.join()
        return self.so_far()

    def next_with(self, word, timeout):
        """The next line with a word, after the one that was returned last."""
        with self._changed:
            while True:
                while self._seen < len(self._lines):
                    self._seen += 1
                    if word in self._lines[self._seen - 1]:
                        return self._lines[self._seen - 1]
                if self._has_ended or not self._changed.wait(timeout):
                    raise AssertionError(f"no {word!r} in: {''.join(self._lines)}")


class _Result(unittest.TextTestResult):
    """Has a folder for each case while it runs, and keeps those of cases that fail."""

    def startTest(self, test):
        global _case
        super().startTest(test)
        self._bad_before = self._bad()
        _case = os.path.join(FOLDER, re.sub(r"[^\w.]", "_", test.id().removeprefix("__main__.")))

    def stopTest(self, test):
        global _case
        super().stopTest(test)
        if self._bad() == self._bad_before:
            shutil.rmtree(_case, ignore_errors=True)
        _case = FOLDER

    def _bad(self):
        return len(self.failures) + len(self.errors)


class _Runner(unittest.TextTestRunner):
    resultclass = _Result


def run_tests():
    """In place of unittest.main(): says at the end where the logs of cases that failed are."""
    shutil.rmtree(FOLDER, ignore_errors=True)
    result = unittest.main(module="__main__", testRunner=_Runner, exit=False).result
    if result.wasSuccessful():
        atexit.register(shutil.rmtree, FOLDER, ignore_errors=True)
    else:
        print(f"logs of what failed: {FOLDER}", file=sys.stderr)
    sys.exit(0 if result.wasSuccessful() else 1)
