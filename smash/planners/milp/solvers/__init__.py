"""MILP solvers behind one array form."""
