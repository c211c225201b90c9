"""Planning with the whole family of aggregating actions and any costs: what every method can fall back on."""
