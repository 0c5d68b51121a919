"""Tables of contact forces: their solves in worker processes, stored as they end, and the file of results."""
