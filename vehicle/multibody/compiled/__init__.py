"""Equations of motion of a vehicle, and their exact derivatives, in compiled code."""
