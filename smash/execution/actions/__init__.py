"""How the arm carries out each action: pick and place, topple, carry, lift, and those that others add."""
