"""Straight-line C from pointwise UFL expressions, and laws with symbolic parameters."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import count
from typing import Any, TypeVar

import ufl
from ufl import classes
from ufl.algorithms.apply_algebra_lowering import apply_algebra_lowering
from ufl.algorithms.apply_derivatives import apply_derivatives
from ufl.core.expr import Expr

Law = TypeVar("Law")
Component = tuple[int, ...]

FUNCTIONS = {
    **{name: name for name in ("sqrt", "exp", "sin", "cos", "tan", "sinh", "cosh", "tanh", "erf")},
    **{"ln": "log", "asin": "asin", "acos": "acos", "atan": "atan"},
}
COMPARISONS = {"GT": ">", "LT": "<", "GE": ">=", "LE": "<=", "EQ": "==", "NE": "!="}


class Symbols:
    """Source of new symbols, scalar or of a shape; UFL's constants belong to a mesh, of which there is none here.

    UFL sorts operands by the numbers of mesh and constants as text: they are the same for every source, with the same
    number of digits, so that expressions, and code generated from them, do not depend on what was built before.
    """

    def __init__(self) -> None:
        self._numbers = count(100)
        if hasattr(ufl, "VectorElement"):
            element = ufl.VectorElement("Lagrange", ufl.Cell("triangle", geometric_dimension=2), 1)
        else:
            import basix.ufl

            element = basix.ufl.element("Lagrange", "triangle", 1, shape=(2,))
        self._mesh = ufl.Mesh(element, ufl_id=100)

    def new(self, shape: Component = ()) -> Expr:
        return ufl.Constant(self._mesh, shape=shape, count=next(self._numbers))


def with_parameters(law: Law, values: Mapping[str, Any]) -> Law:
    """Copy of a law, a dataclass, with other values of its fields, which may be symbols: they are not checked."""
    symbolic = copy.copy(law)
    for name, value in values.items():
        object.__setattr__(symbolic, name, value)
    return symbolic


def evaluated(law: object, method: str, *arguments: Expr) -> Expr:
    """Scalar expression of a law's method without max_value and min_value, whose derivatives `larger` describes.

    Raises ValueError, with the name of the law, for a result that is no scalar and for laws that UFL cannot express.
    """
    name = f"{type(law).__name__}.{method}"
    try:
        with _no_numbers():
            expression = ufl.as_ufl(getattr(law, method)(*arguments))
    except Exception as error:  # UFL raises various types
        raise ValueError(f"{name} must be an expression in UFL: {error}") from error
    if expression.ufl_shape != ():
        raise ValueError(f"{name} must be a scalar, got the shape {expression.ufl_shape}")
    return _by_conditionals(expression, {})


def derivative(expression: Expr, variable: Expr) -> Expr:
    """d expression / d variable, an object of ufl.variable, evaluated."""
    return apply_derivatives(apply_algebra_lowering(ufl.diff(expression, variable)))


def lowered(expression: Expr) -> Expr:
    """The expression in terms of sums, products and components."""
    return apply_algebra_lowering(expression)


def is_zero(expression: Expr) -> bool:
    """Whether an expression vanishes identically, by its form."""
    return isinstance(expression, classes.Zero)


@contextmanager
def _no_numbers() -> Iterator[None]:
    """Refuse the conversion of expressions to numbers: math.exp(w) does not end under UFL 2022.2."""

    def refuse(_: Expr) -> float:
        raise TypeError("an expression in UFL has no value yet: ufl.exp(w), not math.exp(w)")

    before = Expr.__float__
    Expr.__float__ = refuse
    try:
        yield
    finally:
        Expr.__float__ = before


def _by_conditionals(e: Expr, known: dict[Expr, Expr]) -> Expr:
    if e not in known:
        operands = [_by_conditionals(operand, known) for operand in e.ufl_operands]
        if isinstance(e, classes.MaxValue):
            known[e] = ufl.conditional(ufl.gt(*operands), *operands)
        elif isinstance(e, classes.MinValue):
            known[e] = ufl.conditional(ufl.lt(*operands), *operands)
        else:
            same = all(a is b for a, b in zip(operands, e.ufl_operands, strict=True))
            known[e] = e if same else e._ufl_expr_reconstruct_(*operands)
    return known[e]


class StraightLine:
    """Assignments in C that evaluate components of UFL expressions, each value once.

    Parameters:
        names: variables by symbol; components of a vector have its name with the index appended.

    `lines` has the assignments.
    """

    def __init__(self, names: Mapping[Expr, str]) -> None:
        self.names, self.lines = names, list[str]()
        self._variables: dict[str, str] = {}
        self._values: dict[Any, str] = {}

    def value(self, e: Expr, component: Component = ()) -> str:
        """Variable or number with the value of a component. Raises ValueError for what is not pointwise."""
        return self._value(e, component, {})

    def _value(self, e: Expr, component: Component, indices: dict[Any, int]) -> str:
        free = set(e.ufl_free_indices)
        key = (e, component, tuple(sorted((i.count(), k) for i, k in indices.items() if i.count() in free)))
        if key not in self._values:
            self._values[key] = self._scalar(e, component, indices)
        return self._values[key]

    def _scalar(self, e: Expr, component: Component, indices: dict[Any, int]) -> str:
        if e in self.names:
            return self.names[e] + "".join(map(str, component))
        if isinstance(e, classes.Zero):
            return "0.0"
        if isinstance(e, classes.ScalarValue):
            return _number(float(e))
        if isinstance(e, classes.Identity):
            return "1.0" if component[0] == component[1] else "0.0"
        structural = self._structural(e, component, indices)
        return self._operator(e, component, indices) if structural is None else structural

    def _structural(self, e: Expr, component: Component, indices: dict[Any, int]) -> str | None:
        """Value of an expression that only selects components or sums over an index; None for others."""
        operands = e.ufl_operands
        if isinstance(e, classes.Variable | classes.Real | classes.Conj):  # all values are real
            return self._value(operands[0], component, indices)
        if isinstance(e, classes.Indexed):
            numbers = tuple(int(i) if isinstance(i, classes.FixedIndex) else indices[i] for i in operands[1])
            return self._value(operands[0], numbers, indices)
        if isinstance(e, classes.ComponentTensor):
            return self._value(operands[0], (), {**indices, **dict(zip(operands[1], component, strict=True))})
        if isinstance(e, classes.ListTensor):
            return self._value(operands[component[0]], component[1:], indices)
        if isinstance(e, classes.IndexSum):
            (index,) = operands[1]
            terms = [self._value(operands[0], component, {**indices, index: k}) for k in range(e.dimension())]
            total = terms[0]
            for term in terms[1:]:
                total = self._sum(total, term)
            return total
        return None

    def _operator(self, e: Expr, component: Component, indices: dict[Any, int]) -> str:
        if isinstance(e, classes.Conditional):
            condition = self._condition(e.ufl_operands[0], indices)
            true, false = (self._value(operand, component, indices) for operand in e.ufl_operands[1:])
            return true if true == false else self._assigned(f"{condition} ? {true} : {false}")
        values = [
            self._value(operand, component if operand.ufl_shape else (), indices)
            for operand in e.ufl_operands
            if isinstance(operand, Expr) and not isinstance(operand, classes.MultiIndex)
        ]
        kind = type(e).__name__
        if isinstance(e, classes.Sum):
            return self._sum(*values)
        if isinstance(e, classes.Product):
            a, b = values
            return "0.0" if "0.0" in values else b if a == "1.0" else a if b == "1.0" else self._assigned(f"{a} * {b}")
        if isinstance(e, classes.Division):
            a, b = values
            return "0.0" if a == "0.0" else a if b == "1.0" else self._assigned(f"{a} / {b}")
        if isinstance(e, classes.Power):
            a, b = values
            return a if b == "1.0" else self._assigned(f"{a} * {a}" if b == "2.0" else f"pow({a}, {b})")
        if isinstance(e, classes.Abs):
            return self._assigned(f"fabs({values[0]})")
        if kind == "Sign":
            return self._assigned(f"{values[0]} > 0.0 ? 1.0 : {values[0]} < 0.0 ? -1.0 : 0.0")
        if isinstance(e, classes.MathFunction) and e._name in FUNCTIONS:
            return self._assigned(f"{FUNCTIONS[e._name]}({values[0]})")
        raise ValueError(f"a pointwise law cannot contain UFL's {kind}: {e}")

    def _condition(self, e: Expr, indices: dict[Any, int]) -> str:
        operands, kind = e.ufl_operands, type(e).__name__
        if kind in COMPARISONS:
            a, b = (self._value(operand, (), indices) for operand in operands)
            return f"({a} {COMPARISONS[kind]} {b})"
        conditions = [self._condition(operand, indices) for operand in operands]
        if isinstance(e, classes.NotCondition):
            return f"(!{conditions[0]})"
        return f"({(' && ' if isinstance(e, classes.AndCondition) else ' || ').join(conditions)})"

    def _sum(self, a: str, b: str) -> str:
        return b if a == "0.0" else a if b == "0.0" else self._assigned(f"{a} + {b}")

    def _assigned(self, text: str) -> str:
        if text not in self._variables:
            self._variables[text] = f"t{len(self._variables)}"
            self.lines.append(f"const double {self._variables[text]} = {text};")
        return self._variables[text]


def _number(value: float) -> str:
    text = repr(value)
    return {"inf": "INFINITY", "-inf": "-INFINITY", "nan": "NAN"}.get(text, text)


def straight_line(names: Mapping[Expr, str], outputs: Sequence[tuple[Expr, Component]]) -> tuple[list[str], list[str]]:
    """Straight-line code of expressions: assignments, and the variables that hold the output components."""
    code = StraightLine(names)
    results = [code.value(expression, component) for expression, component in outputs]
    return code.lines, results
