"""The simulated world: the arm, the blocks, time."""
