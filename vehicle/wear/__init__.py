"""Wear of profiles over distance: steps that remove the worn depth."""
