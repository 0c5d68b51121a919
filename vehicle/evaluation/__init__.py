"""Evaluation of measured or computed signals by standards: ride comfort (EN 12299, Sperling). NumPy only."""
