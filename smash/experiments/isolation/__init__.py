"""One run in processes of its own, with limits."""
