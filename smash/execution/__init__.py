"""One executor: Franka Panda in PyBullet, OMPL motions, partially grounded execution."""
