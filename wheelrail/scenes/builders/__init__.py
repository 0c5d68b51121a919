"""Objects of `contact` and `vehicle` built from a validated scene."""
