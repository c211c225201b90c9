"""`smash report`: records of any number of sweeps as one page that needs nothing else, and its parts as files."""
