"""Vehicle runs at the edge of what the models can do."""
