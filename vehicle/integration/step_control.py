"""How the length of a step follows its error, and what was counted on the way."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass
class StepStatistics:
    """Steps accepted, rejected for their error, failed by the right-hand side, and evaluations asked for.

    Of implicit steps also: Jacobians, evaluations for their differences when the contact has no tangent (not among the
    evaluations), and factorisations.
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
    """How the step length follows the error: h safety error^-(proportional/k) before^(integral/k), k = error order + 1.

    proportional 1 and integral 0 is the standard control; the default damps the swing at the limit of stability
    (K. Gustafsson, ACM TOMS 17 (1991) 533-554, DOI 10.1145/210232.210242). retry: factor after a failure.
    """

    safety: float = 0.9
    proportional: float = 0.7
    integral: float = 0.4
    smallest: float = 0.2
    largest: float = 5.0
    retry: float = 0.25

    def factor(self, error: float, before: float, k: int) -> float:
        wanted = self.safety * max(error, 1e-10) ** (-self.proportional / k) * max(before, 1e-4) ** (self.integral / k)
        return float(min(self.largest, max(self.smallest, wanted)))
