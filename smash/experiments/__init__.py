"""Experiments: files, isolated runs with limits, sweeps that resume, records."""
