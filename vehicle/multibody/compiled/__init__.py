"""Equations of motion of a vehicle in compiled code, in complex numbers, whose imaginary parts are derivatives."""
