"""Infrastructure without physics, for all layers: array types, atomic files, disk cache, compiled loops, interrupts,
MPI, console.
"""
