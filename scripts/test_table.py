#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""test_table.py [--requirements] [ROOT]: every test as a row of a table in Markdown: the file, its label, and what it
shows, which is the first sentence of the comment at its top. Ends with 1 if a test says nothing of the kind.

--requirements: those of docs/soup.md instead, each with the tests that name it there ("Requirements: R4, R7."). Ends with 1
if one has no test, or a test names one that there is not."""

import re
import sys
from pathlib import Path

COMMENTS = {
    ".c": re.compile(r"/\*(?! SPDX)(.*?)\*/", re.DOTALL),
    ".sh": re.compile(r"((?:^# (?!SPDX).*\n)+)", re.MULTILINE),
    ".py": re.compile(r'"""(.*?)"""', re.DOTALL),
}
SENTENCE = re.compile(r"(?s).*?[.](?=\s+[A-Z(]|$)|.+")  # a dot in a file's name ends none


def comment(path):
    """A test's comment on one line; "" if it has none."""
    found = COMMENTS[path.suffix].search(path.read_text())
    return " ".join(re.sub(r"(?m)^\s*[*#]+ ?", "", found[1]).split()) if found else ""


def shown(path):
    """The first sentence of it."""
    first = SENTENCE.match(comment(path))
    return first[0].replace("|", "\\|") if first else ""


def requirements(root, tests):
    """Prints the table of requirements, and returns the exit code."""
    named = {}
    for path in tests:
        for names in re.findall(r"Requirements?: ([R0-9, ]+)\.", comment(path)):
            for name in names.split(", "):
                named.setdefault(name, []).append(str(path.relative_to(root)))
    wanted = dict(re.findall(r"(?m)^\| (R[0-9]+) \| (.*) \|$", (root / "docs/soup.md").read_text()))
    print("| id | requirement | tests |\n|---|---|---|")
    for name, text in wanted.items():
        print(f"| {name} | {text} | {', '.join(sorted(named.get(name, [])))} |")
    for name in sorted(named.keys() ^ wanted.keys()):
        why = "no test names it" if name in wanted else f"{named[name][0]} names it, and it is none"
        print(f"test_table: requirement {name}: {why}", file=sys.stderr)
    return 1 if not wanted or named.keys() != wanted.keys() else 0


def main(root, only_requirements):
    """Prints the table, and returns the exit code."""
    tests = [path for ending in COMMENTS for path in root.glob(f"tests/*/*/test_*{ending}")]
    tests += root.glob("python/tests/test_*.py")
    if only_requirements:
        return requirements(root, tests)
    silent = [path for path in tests if not shown(path)]
    print("| test | label | what it shows |\n|---|---|---|")
    for path in sorted(tests):
        label = "python" if path.parent.name == "tests" else path.parent.name
        print(f"| {path.relative_to(root)} | {label} | {shown(path)} |")
    for path in silent:
        print(f"test_table: {path} says not what it shows", file=sys.stderr)
    return 1 if silent or not tests else 0


if __name__ == "__main__":
    arguments = [one for one in sys.argv[1:] if one != "--requirements"]
    sys.exit(main(Path(arguments[0] if arguments else Path(__file__).parent.parent), len(arguments) < len(sys.argv) - 1))
