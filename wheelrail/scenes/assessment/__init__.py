"""Assessment of runs after EN 14363 and EN 12299: signals, sections, estimates, verdict, tables."""
