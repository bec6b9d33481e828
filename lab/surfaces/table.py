# SPDX-License-Identifier: MIT
"""Methods of a plugin on every site, one setting for all cases: error, cut, left, every case, calibration."""

from __future__ import annotations

from collections.abc import Sequence

from sites import Method, Site, Sites, judge_site


def _site(site: Site, methods: Sequence[Method], plugin: str | None) -> None:
    print(site)
    rows = []
    for method in methods:
        with method.open(plugin) as session:
            score, each, q = judge_site(session, site, method.best_q)
            name = method.settings if q is None else f"{method.settings}, best q = {q:.2f}"
            print(f"  {name:<28} {score.line(session.sure)}\n{score.fetus_line()}", flush=True)
            rows.append((name, score, each, session.sure))
    print("  every case, in the order of the methods:")
    for n, case in enumerate(site.cases):
        columns = (each[n] for _, _, each, _ in rows)
        print(
            f"    {case.name:<6}"
            + "".join(f"  {s.error:6.2f} / {100 * s.cut:5.1f} / {100 * s.left:5.1f}" for s in columns)
        )
    for name, score, _, sure in rows:
        if sure:
            print(score.calibration.line(name))
    print()


def table(sites: Sites, methods: Sequence[Method], plugin: str | None) -> None:
    """Prints it."""
    print(
        "Error in slices of 128 / fetus pixels cut by more than 2 slices, % / labelled rays with an occluder left, %\n"
    )
    for site in sites.all:
        _site(site, methods, plugin)
