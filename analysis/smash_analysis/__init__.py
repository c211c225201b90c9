"""Analysis: records to tables, heatmaps and reports; reads files only, starts no planner."""
