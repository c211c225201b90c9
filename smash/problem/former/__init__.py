"""The names of 0.1: each module hands on what now lives elsewhere, for packages that others wrote by them."""
