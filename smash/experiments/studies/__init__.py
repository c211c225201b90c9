"""Studies of their own: first plans and proofs, scaling, what buffers buy, costs from durations."""
