# SPDX-License-Identifier: MIT
"""A batch as one page: of every volume a small picture, what came of it, and where its files are."""

from __future__ import annotations

import os
from collections.abc import Sequence
from html import escape as _escaped
from pathlib import Path
from urllib.parse import quote

from ._files import whole
from ._text import plain
from ._work import Row

_HEAD = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>SmartVis batch</title>
<style>
:root{color-scheme:light dark;--ink:#1c2024;--quiet:#4a5058;--ground:#fff;--link:#0b5cad}
@media screen and (prefers-color-scheme:dark){:root{--ink:#e6e8eb;--quiet:#aab2bb;--ground:#16181b;--link:#7ab8f5}}
body{font:16px/1.5 system-ui,sans-serif;color:var(--ink);background:var(--ground);max-width:80rem;margin:0 auto;
padding:1rem}
h1{font-size:1.7rem;line-height:1.2}p,ul{max-width:46rem}a{color:var(--link)}
main{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(22rem,100%),1fr));gap:1.5rem 1rem}
figure{margin:0;min-width:0;break-inside:avoid}
img{width:100%;height:auto;max-height:12rem;object-fit:contain;background:#000;border-radius:4px;display:block}
figcaption,li{overflow-wrap:anywhere}figcaption span{display:block;font-size:.9rem;color:var(--quiet)}
</style>
</head>
<body>
"""
_ABOUT = """<a href="table.csv">The table</a> has all figures. Three pictures of each volume: its brightest voxels along
every ray; what is left, shaded by its first tissue; a cut from the side, in which what was clipped is dark and the
surface orange."""
_OUTCOMES = {"OK": "clipped", "PARTIAL": "clipped, but for some rays", "NO_SURFACE": "nothing was clipped"}


def escape(text: str) -> str:
    """For HTML."""
    return _escaped(plain(text))


def write_page(path: Path, rows: Sequence[tuple[Row, Path]]) -> Path:
    """The rows, each with the folder of its results, as `path` in a folder above them."""
    several = {row.file for row, _ in rows if row.frame > 0}
    volumes = len({(row.file, row.frame) for row, _ in rows})
    failed = [row for row, _ in rows if row.state != "ok"]
    clipped = sum(row.outcome in ("OK", "PARTIAL") for row, _ in rows)
    many = f", each with {len(rows) // volumes} settings" if len(rows) > volumes else ""
    text = f"{_HEAD}<h1>{volumes} volume{'s' * (volumes != 1)}{many}</h1>\n<p>{clipped} were clipped. In "
    text += (
        f"{len(rows) - clipped - len(failed)} the plugin found nothing to clip. {len(failed)} failed. {_ABOUT}</p>\n"
    )
    if failed:
        reasons = dict.fromkeys(_of_failure(row, row.file in several) for row in failed)
        told = "".join(f"<li>{escape(reason)}</li>\n" for reason in reasons)
        text += f"<h2>Failed</h2>\n<ul>\n{told}</ul>\n<h2>Done</h2>\n"
    figures = "".join(
        _figure(row, path.parent, folder, row.file in several) for row, folder in rows if row.state == "ok"
    )
    text += f"<main>\n{figures}</main>\n</body>\n</html>\n"
    return whole(path, lambda part: part.write_text(text, encoding="utf-8", errors="backslashreplace"))


def _name(row: Row, numbered: bool) -> str:
    path = Path(row.file)
    return f"{path.parent.name}/{path.name}" + (f" [{row.frame}]" if numbered else "")


def _of_failure(row: Row, numbered: bool) -> str:
    return row.reason if row.reason.startswith(row.file) else f"{_name(row, numbered)}: {row.reason}"


def _figure(row: Row, page: Path, folder: Path, numbered: bool) -> str:
    link = quote(os.fsencode(folder.relative_to(page)))
    name, outcome = escape(_name(row, numbered)), _OUTCOMES[row.outcome]
    found = f"; {100 * row.clipped_share:.0f} % of the rays, {row.depth_mm:.1f} {row.unit} on average"
    if row.confidence is not None:
        found += f"; confidence {row.confidence:.2f}"
    notes = [
        f"Set: {row.settings}" if row.settings else "",
        f"Beams: {row.beams}",
        row.why,
        f"Try: {row.try_this}" if row.try_this else "",
        row.doubt if row.doubt != row.why else "",
    ]
    told = "".join(f"<span>{escape(note)}</span>" for note in notes if note)
    picture = f'<img src="{link}/{quote(os.fsencode(row.picture))}" alt="{name}, {outcome}" loading="lazy">'
    facts = f"{row.width} x {row.height} x {row.slices}, {outcome}{found if row.clipped_share else ''}"
    caption = f"{name}<span>{facts}</span>{told}"
    return f'<figure><a href="{link}/">{picture}</a>\n<figcaption>{caption}</figcaption></figure>\n'
