"""Python source of the loops over points of a law, generated from its UFL expression and UFL's derivatives."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from wheelrail.contact.laws.friction import FrictionLaw, parameters
from wheelrail.contact.laws.normal import NormalLaw

if TYPE_CHECKING:
    from ufl.core.expr import Expr

HEAD = "import math\n\nimport numpy as np\nfrom numba import carray\n"

FRICTION = """
DEPENDS_ON_SPEED, DEPENDS_ON_PRESSURE = {depends}


def coefficient(w, p, parameters):
    out = np.empty(len(p))
{parameters}
    for i in range(len(p)):
        w_, p_ = w[i], p[i]
{coefficient}
        out[i] = {coefficient_out}
    return out


def residual(q, s, p, rho, speed, eps, parameters):
    n = len(p)
    bound, F, total = np.empty(n), np.empty((2, n)), 0.0
{parameters}
    for i in range(n):
        q0, q1, s0, s1, p_, rho_ = q[0, i], q[1, i], s[0, i], s[1, i], p[i], rho[i]
{residual}
        bound[i], F[0, i], F[1, i] = {residual_out}
        total += F[0, i] * F[0, i] + F[1, i] * F[1, i]
    return bound, F, math.sqrt(total)


def mean_residual(q, s, p, rho, speed, eps, parameters, out):
{parameters}
    for i in range(q.shape[1]):
        q0, q1, s0, s1, low, high, rho_ = q[0, i], q[1, i], s[0, i], s[1, i], p[0, i], p[1, i], rho[i]
{mean_residual}
        out[0, i], out[1, i] = {mean_residual_out}


def mean_residual_at(q, s, p, rho, counts, numbers, parameters, out):
    n, own = carray(counts, (2,))
    speed, eps = carray(numbers, (2,))
    mean_residual(
        carray(q, (2, n)), carray(s, (2, n)), carray(p, (2, n)), carray(rho, (n,)), speed, eps,
        carray(parameters, (own,)), carray(out, (2, n)),
    )


def bounds(s, p, speed, parameters, out):
{parameters}
    for i in range(len(p)):
        s0, s1, p_ = s[0, i], s[1, i], p[i]
{bound}
        out[i] = {bound_out}


def bounds_at(s, p, counts, speed, parameters, out):
    n, own = carray(counts, (2,))
    bounds(carray(s, (2, n)), carray(p, (n,)), speed[0], carray(parameters, (own,)), carray(out, (n,)))


def bounded_residual(q, s, bound, rho, eps):
    n = len(bound)
    F, total = np.empty((2, n)), 0.0
    for i in range(n):
        q0, q1, s0, s1, b_, rho_ = q[0, i], q[1, i], s[0, i], s[1, i], bound[i], rho[i]
{bounded}
        F[0, i], F[1, i] = {bounded_out}
        total += F[0, i] * F[0, i] + F[1, i] * F[1, i]
    return F, math.sqrt(total)


def slopes(index, q, s, p, rho, speed, eps, parameters):
    out = np.empty((len(index), 12))
{parameters}
    for k in range(len(index)):
        i = index[k]
        q0, q1, s0, s1, p_, rho_ = q[0, i], q[1, i], s[0, i], s[1, i], p[i], rho[i]
{slopes}
        {slopes_out}
    return out


def mean_slopes(q, s, p, rho, speed, eps, parameters, out):
{parameters}
    for i in range(q.shape[1]):
        q0, q1, s0, s1, low, high, rho_ = q[0, i], q[1, i], s[0, i], s[1, i], p[0, i], p[1, i], rho[i]
{mean_slopes}
        {mean_slopes_out}


def mean_slopes_at(q, s, p, rho, counts, numbers, parameters, out):
    n, own = carray(counts, (2,))
    speed, eps = carray(numbers, (2,))
    mean_slopes(
        carray(q, (2, n)), carray(s, (2, n)), carray(p, (2, n)), carray(rho, (n,)), speed, eps,
        carray(parameters, (own,)), carray(out, (n, 14)),
    )


def bounded_slopes(index, q, s, bound, rho, eps):
    out = np.zeros((len(index), 12))
    for k in range(len(index)):
        i = index[k]
        q0, q1, s0, s1, b_, rho_ = q[0, i], q[1, i], s[0, i], s[1, i], bound[i], rho[i]
{bounded_slopes}
        {bounded_slopes_out}
    return out
"""

PRESSURE = """

def pressure(d, parameters):
    p, slope = np.empty(len(d)), np.empty(len(d))
{parameters}
    for i in range(len(d)):
        d_ = d[i]
{pressure}
        p[i], slope[i] = {pressure_out}
    return p, slope
"""

VECTOR: list[tuple[int, ...]] = [(0,), (1,)]
MATRIX: list[tuple[int, ...]] = [(0, 0), (0, 1), (1, 0), (1, 1)]
COMPONENTS: dict[str, list[tuple[int, ...]]] = {"q": MATRIX, "s": MATRIX, "p": VECTOR, "V": VECTOR}


def friction_source(law: FrictionLaw) -> str:
    """Source of the functions of `wheelrail.contact.laws.pointwise.FrictionFunctions` for all laws of a class.

    F = q - b y / max(|y|, b rho + eps) and its slopes, b = mu p; with given bounds b, and in the mean of cells, too.
    """
    import ufl

    from wheelrail.forms import pointwise
    from wheelrail.forms.traction import length, mean_projected, projected

    symbols = pointwise.Symbols()
    own = {name: symbols.new() for name in parameters(law)}
    names: dict[Expr, str] = {symbol: f"own_{name}" for name, symbol in own.items()}

    def variable(name: str, shape: tuple[int, ...] = ()) -> Expr:
        symbol = symbols.new(shape)
        names[symbol] = name
        return ufl.variable(symbol)

    q, s, p, V, w = variable("q", (2,)), variable("s", (2,)), variable("p_"), variable("speed"), variable("w_")
    rho, eps, b = variable("rho_"), variable("eps"), variable("b_")
    symbolic = pointwise.with_parameters(law, own)
    mu = pointwise.evaluated(symbolic, "coefficient", w, p)
    bound = pointwise.evaluated(symbolic, "coefficient", length(s) * V, p) * p
    ends = variable("low"), variable("high")
    bounds = tuple(pointwise.evaluated(symbolic, "coefficient", length(s) * V, end) * end for end in ends)
    F, G, H = projected(q, s, bound, rho, eps), projected(q, s, b, rho, eps), mean_projected(q, s, bounds, rho, eps)
    diff = pointwise.derivative
    depends = tuple(not pointwise.is_zero(diff(mu, x)) for x in (w, p))
    dF = {name: diff(F, x) for name, x in (("q", q), ("s", s), ("p", p), ("V", V))}
    by_vectors = [(diff(H, x), i) for x in (q, s) for i in MATRIX]
    by_numbers = [(diff(H, x), i) for x in (*ends, V) for i in VECTOR]
    return HEAD + FRICTION.format(
        depends=depends,
        parameters=_block((f"own_{name} = parameters[{i}]" for i, name in enumerate(own)), 4),
        **_loop("coefficient", names, [(pointwise.lowered(mu), ())]),
        **_loop(
            "residual",
            names,
            [(pointwise.lowered(bound), ()), *((pointwise.lowered(F), i) for i in VECTOR)],
        ),
        **_loop("bound", names, [(pointwise.lowered(bound), ())]),
        **_loop("mean_residual", names, [(pointwise.lowered(H), i) for i in VECTOR]),
        **_loop("mean_slopes", names, [*by_vectors, *by_numbers], "i"),
        **_loop("bounded", names, [(pointwise.lowered(G), i) for i in VECTOR]),
        **_loop("slopes", names, [(dF[x], i) for x, at in COMPONENTS.items() for i in at], "k"),
        **_loop("bounded_slopes", names, [(diff(G, x), i) for x in (q, s) for i in MATRIX], "k"),
    )


def pressure_source(law: NormalLaw) -> str:
    """Source of the pressure p(d) and its slope for all normal laws of a class."""
    import ufl

    from wheelrail.forms import pointwise

    symbols = pointwise.Symbols()
    own = {name: symbols.new() for name in parameters(law)}
    symbol = symbols.new()
    d = ufl.variable(symbol)
    p = pointwise.evaluated(pointwise.with_parameters(law, own), "pressure", d)
    names = {symbol: "d_", **{constant: f"own_{name}" for name, constant in own.items()}}
    return HEAD + PRESSURE.format(
        parameters=_block((f"own_{name} = parameters[{i}]" for i, name in enumerate(own)), 4),
        **_loop("pressure", names, [(pointwise.lowered(p), ()), (pointwise.derivative(p, d), ())]),
    )


def _loop(
    name: str, names: dict[Expr, str], outputs: list[tuple[Expr, tuple[int, ...]]], row: str = ""
) -> dict[str, str]:
    """Body of a loop, and its results as a tuple or as the entries of a row of `out`."""
    from wheelrail.forms.pointwise import straight_line

    lines, results = straight_line(names, outputs)
    if row:
        text = "\n        ".join(f"out[{row}, {j}] = {result}" for j, result in enumerate(results))
    else:
        text = ", ".join(results)
    return {name: _block(lines, 8), f"{name}_out": text}


def _block(lines: Iterable[str], indent: int) -> str:
    return "\n".join(" " * indent + line for line in lines)
