"""Records: what runs, episodes and trials leave on disk, one schema for whoever writes or reads them."""
