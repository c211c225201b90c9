"""An instance seen as planners look at it: numbered, as demands, as target piles, as its plain twin."""
