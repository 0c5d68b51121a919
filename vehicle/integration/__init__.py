"""Embedded Runge-Kutta and Rosenbrock-W methods with step control; knows no vehicles."""
