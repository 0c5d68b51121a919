"""A Hertz scene on coarse meshes of solids."""

SOLIDS = """
kind = "hertz"
model = "full"
laws = "paper"
friction = 0.0
approach = 15e-6
surface_size = 6e-3
upper = {radii = [0.46, 0.3], E = 210e9, nu = 0.3}
lower = {radii = [inf, 0.3], E = 210e9, nu = 0.3}
"""
