# SPDX-License-Identifier: Apache-2.0
"""prose_check.py SOURCE: counts two constructions that make a text hard to read, in the comments and
documents of a source tree, and fails above a rate per 1,000 sentences.

A noun clause ("what a motion removes") hides the noun that the reader looks for: "the removed
volume". "beside" has three meanings: next to, in addition to, while. See CONTRIBUTING.md."""
import pathlib
import re
import subprocess
import sys

LIMITS = {"what": 4.0, "beside": 0.5}
PATTERNS = {
    "what": re.compile(r"\b[Ww]hat\s+(?!if\b|about\b|happens\b|to do\b|kind\b|type\b)"
                       r"(?:the|an?|it|they|is|was|are|were|ha[sd]|can(?:not)?|one|others?|another|no|only|[a-z]+s)\b"),
    "beside": re.compile(r"\bbeside\b"),
}
CODE = {".h", ".cpp", ".c", ".ts", ".tsx", ".mjs", ".js"}
SKIPPED = ("CHANGELOG.md", "CONTRIBUTING.md", "tests/arch/prose_check")
COMMENT = re.compile(r"^\s*(?://[/!]*<?|\*)\s?(.*)|//[/!]*<\s(.*)$")


def paragraphs(name, text):
    """The paragraphs of prose in a file: blocks of comments, or paragraphs of Markdown without code."""
    if name.endswith(".md"):
        return re.split(r"\n\s*\n", re.sub(r"```.*?```", "", text, flags=re.S))
    if pathlib.PurePath(name).suffix not in CODE:
        return []
    blocks, block = [], []
    for line in [*text.split("\n"), ""]:
        found = COMMENT.search(line)
        if found:
            block.append(found.group(1) or found.group(2) or "")
        elif block:
            blocks.append(" ".join(block))
            block = []
    return blocks


def sentences(prose):
    """Number of sentences; a paragraph has at least one."""
    return sum(max(1, len(re.findall(r"[.!?](?:\s|$)", one))) for one in prose if one.strip())


def rates(files):
    """Occurrences of each construction per 1,000 sentences, and their texts, of {name: text}."""
    prose = [one for name, text in files.items() for one in paragraphs(name, text)]
    count = max(1, sentences(prose))
    found = {rule: [(match.group(), one) for one in prose for match in pattern.finditer(one)]
             for rule, pattern in PATTERNS.items()}
    return {rule: (1000 * len(texts) / count, texts) for rule, texts in found.items()}


def tree(source):
    """The files of a checkout that git tracks: {name: text}."""
    names = subprocess.run(["git", "ls-files"], cwd=source, check=True, capture_output=True, text=True).stdout.split("\n")
    return {name: (source / name).read_text(errors="replace") for name in names
            if name and not name.startswith(SKIPPED) and (source / name).is_file()
            and pathlib.PurePath(name).suffix in CODE | {".md"}}


def main():
    failed = False
    for rule, (rate, texts) in rates(tree(pathlib.Path(sys.argv[1]))).items():
        print(f'"{rule}": {rate:.1f} of 1,000 sentences; at most {LIMITS[rule]}')
        if rate > LIMITS[rule]:
            failed = True
            for match, paragraph in texts[:40]:
                print(f"  {match}: {paragraph.strip()[:110]}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
