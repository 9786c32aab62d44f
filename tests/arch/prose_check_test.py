# SPDX-License-Identifier: Apache-2.0
"""The rule about prose finds its two constructions in comments and documents, and nowhere else."""
import unittest

from prose_check import paragraphs, rates, sentences

HARD = {"a.h": "/// Returns what a motion removes.\nint a();\n",
        "a.cpp": "int b = 1;  ///< what is left\n",
        "a.md": "The page stands beside it.\n\nWhat the agent knows is here.\n",
        "a.ts": "// It runs beside the page.\n"}
PLAIN = {"a.h": "/// Decides what happens next. What if it fails?\nint what(int is);\n",
         "a.cpp": 'const char* text = "what is beside it";\n',
         "a.md": "```\nwhat the code says, beside\n```\n\nAs plain as that.\n",
         "a.json": "what the file is, beside"}


class ProseCheck(unittest.TestCase):
    def test_each_construction_is_counted(self):
        found = rates(HARD)
        self.assertEqual(len(found["what"][1]), 3)
        self.assertEqual(len(found["beside"][1]), 2)
        self.assertEqual(found["what"][0], 1000 * 3 / 5)

    def test_code_and_questions_are_not(self):
        found = rates(PLAIN)
        self.assertEqual(found["what"][1], [])
        self.assertEqual(found["beside"][1], [])

    def test_a_block_of_comments_is_one_paragraph(self):
        self.assertEqual(paragraphs("a.h", "// One sentence\n// on two lines. Two.\nint x;\n// Three\n"),
                         ["One sentence on two lines. Two.", "Three"])
        self.assertEqual(sentences(["One sentence on two lines. Two.", "Three"]), 3)


if __name__ == "__main__":
    unittest.main()
