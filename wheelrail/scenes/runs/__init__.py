"""Vehicle runs of a scene: simulation, checkpoints, resume, comparison, steady states."""
