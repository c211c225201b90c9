"""Instances and plans as files, read strictly and written whole."""
