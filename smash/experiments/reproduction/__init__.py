"""Every table and figure from nothing, stage by stage, with a manifest."""
