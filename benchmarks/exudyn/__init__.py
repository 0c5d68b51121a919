"""The wagon compared with Exudyn."""
