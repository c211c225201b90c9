"""Planners: one protocol, one registry, and the package's own methods (paper, section "Method")."""
