"""Measurements of the executor: where toppled blocks land, how fast motions are planned."""
