"""Single contact solves of a scene, and their report."""
