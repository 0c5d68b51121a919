"""Time and memory over contact points and unknowns."""
