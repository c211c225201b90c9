"""Analysis: records to tables, heatmaps and reports; reads files only, starts no planner."""

import sys

from smash.problem.extras import TABLES, MissingExtra, require

if sys.argv[:1] == ["-m"]:  # `python -m smash_analysis.NAME`: what it lacks is one line, before its imports are
    try:
        require(f"python -m {__name__}", *TABLES)
    except MissingExtra as error:
        print(f"smash: {error}", file=sys.stderr)
        sys.exit(error.exit_code)
