"""Planners: the protocol, the MILP and its solvers, the gadget's models, the exact methods.

Modules that planners of others import by the names that they had in 0.1 (`smash.planners.demands`, …) are found in
`former/`, one line each: what was promised to stay importable.
"""

import os

__path__.append(os.path.join(os.path.dirname(__file__), "former"))
