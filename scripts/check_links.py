# SPDX-License-Identifier: MIT
"""check_links.py FILE...: every link of these Markdown files to a file or a heading of the project must lead there, and no sentence
outside of tables has more than 30 words, code and numbers not counted. Prints what is wrong; exit code 1 if there is any."""

import os
import re
import sys

LINK = re.compile(r"\]\(([^()\s]+)\)")
FENCE = re.compile(r"^ *```.*?^ *```", re.MULTILINE | re.DOTALL)
LINE_OF_CODE = re.compile(r"`[^`]*`|<!--.*?-->", re.DOTALL)
BLOCK = re.compile(r"\n\s*\n|\n(?=\s*(?:[-*] |\d+\. |#|\||    ))")
SENTENCE = re.compile(r"(?<=[.!?:;])[)\"*]*\s+")
WORDS = 30
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


def long_sentences(text):
    """Those that nobody reads at once; of a block of text that is no table and no example."""
    text = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", LINE_OF_CODE.sub("", text))
    for block in BLOCK.split(text):
        if not re.match(r"    |\||#", block):
            yield from (s for s in SENTENCE.split(block) if len(re.findall(r"[^\W\d_][\w'-]*", s)) > WORDS)


def main():
    found = 0
    for path in sys.argv[1:]:
        for sentence in long_sentences(text_of(path)):
            print(f"{path}: more than {WORDS} words: {' '.join(sentence.split())}")
            found += 1
        for link in LINK.findall(text_of(path)):
            reason = wrong(path, link)
            if reason:
                print(f"{path}: {link}: {reason}")
                found += 1
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
