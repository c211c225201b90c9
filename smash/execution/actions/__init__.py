"""How the arm carries out each action: free motions, pick and place, topple, carry, lift, and those that others add."""
