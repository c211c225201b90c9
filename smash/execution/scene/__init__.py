"""The table: where stacks and buffers stand, what stands on them, the file that says so."""
