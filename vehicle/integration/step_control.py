"""Step length control and step statistics."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass
class StepStatistics:
    """Counts of an integration.

    Parameters:
        accepted, rejected, failed: steps accepted, rejected for their error, failed in the right-hand side.
        evaluations: of the right-hand side.
        jacobians, factorisations: of implicit steps.
        differences: evaluations for difference quotients of a contact without tangent, not included in `evaluations`.
    """

    accepted: int = 0
    rejected: int = 0
    failed: int = 0
    evaluations: int = 0
    jacobians: int = 0
    differences: int = 0
    factorisations: int = 0


@dataclass(frozen=True)
class StepController:
    """PI step length control: new h = h safety error^-(proportional/k) before^(integral/k), k = error order + 1.

    Parameters:
        safety: factor.
        proportional, integral: exponents; 1 and 0 is the standard control, the default damps oscillations of the step
            length at the stability limit (K. Gustafsson, ACM TOMS 17 (1991) 533-554, DOI 10.1145/210232.210242).
        smallest, largest: bounds of the factor.
        retry: factor after a failure.
    """

    safety: float = 0.9
    proportional: float = 0.7
    integral: float = 0.4
    smallest: float = 0.2
    largest: float = 5.0
    retry: float = 0.25

    def factor(self, error: float, before: float, k: int) -> float:
        """Factor of the step length; errors of this and of the previous step in tolerances, k = error order + 1."""
        factor = self.safety * max(error, 1e-10) ** (-self.proportional / k) * max(before, 1e-4) ** (self.integral / k)
        return float(min(self.largest, max(self.smallest, factor)))
