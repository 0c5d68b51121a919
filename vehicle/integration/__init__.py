"""Embedded Runge-Kutta and Rosenbrock-W methods with step control, independent of the vehicle."""
