# SPDX-License-Identifier: Apache-2.0
"""The rule about the cost of a build reads what ninja prints, and fails when a build has grown."""
import pathlib
import tempfile
import unittest

from build_cost import fault, included_by_unit, megabytes, stated_in

LISTING = """a.o: #deps 2, deps mtime 1 (VALID)
    a.cpp
    shared.h

b.o: #deps 2, deps mtime 2 (VALID)
    cmake_pch.hxx.gch
    shared.h
"""


class BuildCost(unittest.TestCase):
    def test_a_unit_costs_what_it_includes_without_precompiled_headers(self):
        included = included_by_unit(LISTING)
        self.assertEqual(included, {"a.o": ["a.cpp", "shared.h"], "b.o": ["cmake_pch.hxx.gch", "shared.h"]})
        with tempfile.TemporaryDirectory() as folder:
            for name, size in (("a.cpp", 1000), ("shared.h", 500), ("cmake_pch.hxx.gch", 9000)):
                (pathlib.Path(folder) / name).write_bytes(bytes(size))
            build = pathlib.Path(folder)
            self.assertEqual({unit: megabytes(build, files) for unit, files in included.items()},
                             {"a.o": 0.0015, "b.o": 0.0005})

    def test_a_build_may_grow_by_a_tenth(self):
        self.assertEqual(fault(110, 100), "")
        self.assertIn("reads 111 MB of source, more than a tenth above the 100 MB", fault(111, 100))

    def test_the_newest_sum_of_the_changelog_counts(self):
        self.assertEqual(stated_in("* A build reads 120\n  MB of source.\n* It reads 100 MB of source."), 120)
        with self.assertRaisesRegex(SystemExit, "does not state"):
            stated_in("* Nothing.")


if __name__ == "__main__":
    unittest.main()
