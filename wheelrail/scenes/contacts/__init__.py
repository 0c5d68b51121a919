"""Single contact solves of a scene: the solution as a Dataset, its JSON and its table."""
