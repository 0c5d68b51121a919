"""From a checked scene to the objects of `contact` and `vehicle`."""
