"""The gadgets: pick-and-place and SMASH as typed graphs, their drawing, and plans as pebble motions."""
