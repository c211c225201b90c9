"""The table: where stacks and buffers stand, what stands on them and where, the file that says so."""
