"""The command `wheelrail`."""
