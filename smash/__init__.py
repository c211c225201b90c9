"""Planning with topple actions: the law, the SMASH gadget, its planners, and one executor."""
