"""Equations of motion of a vehicle in compiled code, for real states and for complex ones, whose imaginary parts are
derivatives.
"""
