"""The layered model of the whole family: pick, place, topple, carry and lift, at the instance's own costs."""
