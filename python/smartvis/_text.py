# SPDX-License-Identifier: MIT
"""Text from files, names and other programs, for terminals and pages."""

import re

_NOT_SHOWN = re.compile("[\x00-\x09\x0b-\x1f\x7f-\x9f\udc80-\udcff]")


def plain(text: object) -> str:
    r"""What acts on a terminal, or is no text, as what it is: \x1b. Newlines stay. As host_sim has it.

    >>> print(plain("a\x1b[2J\x07.nrrd"))
    a\x1b[2J\x07.nrrd
    """
    return _NOT_SHOWN.sub(lambda found: f"\\x{ord(found[0]) & 0xFF:02x}", str(text))
