# SPDX-License-Identifier: MIT
"""python lab/surfaces COMMAND: judges of surfaces. Needs the package, and SciPy for marks (scripts/surfaces.sh)."""

from commands import main

from smartvis import cli

cli.run(lambda: cli.guarded(main))
