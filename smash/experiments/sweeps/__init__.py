"""Experiment files and the sweeps that run them, here or on a cluster."""
