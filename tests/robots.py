"""The robots that tests use."""

from smash.motion.robots import load_robot

PANDA = load_robot("panda")
READY = PANDA.ready
