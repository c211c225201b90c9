"""The network of places: layered models for carriers, lifts and the costs of edges."""
