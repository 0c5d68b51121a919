"""Creep forces of a sphere by CONTACT, an independent program."""

# Sphere of 0.46 m on a plane, 57 kN, mu = 0.3: creepages xi, eta, spin [1/m] and Fx, Fy over mu F, Mz over mu F a.
# CONTACT (open source, revision 2707), extrapolated from grids of up to 200 x 40 elements, uncertain by 0.002.
CONTACT_SPHERE = [
    ((-0.00080085, 0.0, 0.0), (0.4283, 0.0, 0.0)),
    ((0.0, -0.00092360, 0.0), (0.0, 0.4268, -0.1192)),
    ((0.0, 0.0, 0.41399), (0.0, -0.4530, -0.2617)),
    ((-0.00080085, -0.00055416, 0.16560), (0.3908, 0.0626, -0.1731)),
    ((-0.00048051, 0.00055416, 0.24840), (0.2213, -0.5231, -0.1072)),
    ((-0.0048051, -0.0036944, 2.48396), (0.4016, -0.0209, -0.5080)),
]
