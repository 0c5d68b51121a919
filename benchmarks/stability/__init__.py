"""Random stress test of the contact models."""
