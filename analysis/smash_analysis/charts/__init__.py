"""Charts: small panels, curves, heatmaps."""
