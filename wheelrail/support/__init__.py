"""What every layer needs and no physics is in: array types, atomic files, the disk cache, compiled loops, interrupts,
MPI, console.
"""
