"""The commands of `wheelrail`, by what they are for."""
