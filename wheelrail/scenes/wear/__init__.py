"""Wear of wheel profiles over distance: duty of runs and steady curves, loop of steps, results."""
