"""Episodes of a sweep's plans, and trials of topples, in processes of their own."""
