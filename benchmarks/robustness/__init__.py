"""Vehicle runs at the limits of the models."""
