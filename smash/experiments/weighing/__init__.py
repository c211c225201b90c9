"""Plans chosen for what their execution takes: `--objective seconds` and `--robust`.

Planners count actions. Here their plans are weighed: with topple and without, what annealing makes of them, and of the
fastest of these those whose motions, rehearsed, take the least time. The plan without topple is always among them.
"""
