"""Evaluation of signals by standards: ride comfort (EN 12299, Sperling), running safety (EN 14363)."""
