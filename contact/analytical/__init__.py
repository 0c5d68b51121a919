"""Closed-form solutions of contact problems, with SciPy and the standard library only.

`hertz` for the normal contact of quadratic surfaces, `Cattaneo` for a tangential displacement, `Carter` for rolling of
cylinders, and Kalker's linear theory of rolling contact.
"""
