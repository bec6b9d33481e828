# SPDX-License-Identifier: MIT
"""check_links.py FILE...: every link of these Markdown files to a file or a heading of the project must lead there. Prints
those that do not; exit code 1 if there is one."""

import os
import re
import sys

LINK = re.compile(r"\]\(([^()\s]+)\)")
FENCE = re.compile(r"^ *```.*?^ *```", re.MULTILINE | re.DOTALL)
HEADING = re.compile(r"^#+ +(.*?) *$", re.MULTILINE)


def text_of(path):
    with open(path, encoding="utf-8") as file:
        return FENCE.sub("", file.read())


def anchors(path):
    """What a heading is called in an address: its words in lower case, joined by hyphens."""
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in HEADING.findall(text_of(path))}


def wrong(path, link):
    """What is wrong with a link in the file at `path`, or nothing."""
    if re.match(r"[a-z]+:", link):
        return None
    name, _, anchor = link.partition("#")
    target = os.path.normpath(os.path.join(os.path.dirname(path), name)) if name else path
    if not os.path.exists(target):
        return f"there is no {target}"
    if anchor and target.endswith(".md") and anchor not in anchors(target):
        return f"{target} has no heading of that name"
    return None


def main():
    found = 0
    for path in sys.argv[1:]:
        for link in LINK.findall(text_of(path)):
            reason = wrong(path, link)
            if reason:
                print(f"{path}: {link}: {reason}")
                found += 1
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
