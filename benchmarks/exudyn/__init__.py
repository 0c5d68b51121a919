"""The wagon and the vehicle in three dimensions compared with Exudyn."""
