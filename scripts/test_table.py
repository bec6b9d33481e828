#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""test_table.py [ROOT]: every test as a row of a table in Markdown: the file, its label, and what it shows, which is
the first sentence of the comment at its top. Ends with 1 if a test says nothing of the kind."""

import re
import sys
from pathlib import Path

COMMENTS = {
    ".c": re.compile(r"/\*(?! SPDX)(.*?)\*/", re.DOTALL),
    ".sh": re.compile(r"((?:^# (?!SPDX).*\n)+)", re.MULTILINE),
    ".py": re.compile(r'"""(.*?)"""', re.DOTALL),
}
SENTENCE = re.compile(r"(?s).*?[.](?=\s+[A-Z(]|$)|.+")  # a dot in a file's name ends none


def shown(path):
    """The first sentence of a test's comment, on one line; "" if it has none."""
    found = COMMENTS[path.suffix].search(path.read_text())
    text = " ".join(re.sub(r"(?m)^\s*[*#]+ ?", "", found[1]).split()) if found else ""
    first = SENTENCE.match(text)
    return first[0].replace("|", "\\|") if first else ""


def main(root):
    """Prints the table, and returns the exit code."""
    tests = [path for ending in COMMENTS for path in root.glob(f"tests/*/*/test_*{ending}")]
    tests += root.glob("python/tests/test_*.py")
    silent = [path for path in tests if not shown(path)]
    print("| test | label | what it shows |\n|---|---|---|")
    for path in sorted(tests):
        label = "python" if path.parent.name == "tests" else path.parent.name
        print(f"| {path.relative_to(root)} | {label} | {shown(path)} |")
    for path in silent:
        print(f"test_table: {path} says not what it shows", file=sys.stderr)
    return 1 if silent or not tests else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1] if sys.argv[1:] else Path(__file__).parent.parent)))
