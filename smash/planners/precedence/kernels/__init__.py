"""What is worth compiling of the precedence graph: shortest cycles, an annealed acyclic order, rank inequalities."""
