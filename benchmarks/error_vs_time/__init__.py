"""Work and precision of contact solves."""
