"""C source of the loops over points of a law, printed from its UFL expression and UFL's derivatives.

The functions are those of `FrictionCode` and `PressureCode` in `core/law.hpp`.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from wheelrail.contact.laws.friction import FrictionLaw, parameters
from wheelrail.contact.laws.normal import NormalLaw

if TYPE_CHECKING:
    from ufl.core.expr import Expr

HEAD = """#include <math.h>

#define numbers const double *restrict
#define results double *restrict

const long parameters = {count};
"""

FRICTION = """
const long depends_on_speed = {depends[0]:d}, depends_on_pressure = {depends[1]:d};

void coefficient(long n, numbers w, numbers p, numbers own, results mu)
{{
    for (long i = 0; i < n; ++i) {{
        const double w_ = w[i], p_ = p[i];
{coefficient}
        mu[i] = {coefficient_out[0]};
    }}
}}

void residual(long n, numbers q, numbers s, numbers p, numbers rho, double speed, double eps, numbers own,
              results bound, results F)
{{
    for (long i = 0; i < n; ++i) {{
        const double q0 = q[i], q1 = q[n + i], s0 = s[i], s1 = s[n + i], p_ = p[i], rho_ = rho[i];
{residual}
        bound[i] = {residual_out[0]}, F[i] = {residual_out[1]}, F[n + i] = {residual_out[2]};
    }}
}}

void bounded_residual(long n, numbers q, numbers s, numbers bound, numbers rho, double eps, results F)
{{
    for (long i = 0; i < n; ++i) {{
        const double q0 = q[i], q1 = q[n + i], s0 = s[i], s1 = s[n + i], b_ = bound[i], rho_ = rho[i];
{bounded}
        F[i] = {bounded_out[0]}, F[n + i] = {bounded_out[1]};
    }}
}}

void slopes(long k, const long *index, long n, numbers q, numbers s, numbers p, numbers rho, double speed, double eps,
            numbers own, results rows)
{{
    for (long j = 0; j < k; ++j) {{
        const long i = index[j];
        const double q0 = q[i], q1 = q[n + i], s0 = s[i], s1 = s[n + i], p_ = p[i], rho_ = rho[i];
        double *row = rows + 12 * j;
{slopes}
{slopes_row}
    }}
}}

void bounded_slopes(long k, const long *index, long n, numbers q, numbers s, numbers bound, numbers rho, double eps,
                    results rows)
{{
    for (long j = 0; j < k; ++j) {{
        const long i = index[j];
        const double q0 = q[i], q1 = q[n + i], s0 = s[i], s1 = s[n + i], b_ = bound[i], rho_ = rho[i];
        double *row = rows + 12 * j;
{bounded_slopes}
{bounded_slopes_row}
        row[8] = row[9] = row[10] = row[11] = 0.0;
    }}
}}

void mean_residual(long n, numbers q, numbers s, numbers p, numbers rho, double speed, double eps, numbers own,
                   results F)
{{
    for (long i = 0; i < n; ++i) {{
        const double q0 = q[i], q1 = q[n + i], s0 = s[i], s1 = s[n + i], low = p[i], high = p[n + i], rho_ = rho[i];
{mean_residual}
        F[i] = {mean_residual_out[0]}, F[n + i] = {mean_residual_out[1]};
    }}
}}

void mean_slopes(long n, numbers q, numbers s, numbers p, numbers rho, double speed, double eps, numbers own,
                 results rows)
{{
    for (long i = 0; i < n; ++i) {{
        const double q0 = q[i], q1 = q[n + i], s0 = s[i], s1 = s[n + i], low = p[i], high = p[n + i], rho_ = rho[i];
        double *row = rows + 14 * i;
{mean_slopes}
{mean_slopes_row}
    }}
}}

void bounds(long n, numbers s, numbers p, double speed, numbers own, results bound)
{{
    for (long i = 0; i < n; ++i) {{
        const double s0 = s[i], s1 = s[n + i], p_ = p[i];
{bound}
        bound[i] = {bound_out[0]};
    }}
}}
"""

PRESSURE = """
void pressure(long n, numbers d, numbers own, results p, results slope)
{{
    for (long i = 0; i < n; ++i) {{
        const double d_ = d[i];
{pressure}
        p[i] = {pressure_out[0]}, slope[i] = {pressure_out[1]};
    }}
}}
"""

VECTOR: list[tuple[int, ...]] = [(0,), (1,)]
MATRIX: list[tuple[int, ...]] = [(0, 0), (0, 1), (1, 0), (1, 1)]
COMPONENTS: dict[str, list[tuple[int, ...]]] = {"q": MATRIX, "s": MATRIX, "p": VECTOR, "V": VECTOR}


def friction_source(law: FrictionLaw) -> str:
    """Source of the functions of all friction laws of a class.

    F = q - b y / max(|y|, b rho + eps) and its slopes, b = mu p; with given bounds b, and in the mean of cells, too.
    """
    import ufl

    from wheelrail.forms import pointwise
    from wheelrail.forms.traction import length, mean_projected, projected

    symbols = pointwise.Symbols()
    own = {name: symbols.new() for name in parameters(law)}
    names: dict[Expr, str] = {symbol: f"own[{i}]" for i, symbol in enumerate(own.values())}

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
    return HEAD.format(count=len(own)) + FRICTION.format(
        depends=depends,
        **_loop("coefficient", names, [(pointwise.lowered(mu), ())]),
        **_loop("residual", names, [(pointwise.lowered(bound), ()), *((pointwise.lowered(F), i) for i in VECTOR)]),
        **_loop("bound", names, [(pointwise.lowered(bound), ())]),
        **_loop("mean_residual", names, [(pointwise.lowered(H), i) for i in VECTOR]),
        **_loop("mean_slopes", names, [*by_vectors, *by_numbers]),
        **_loop("bounded", names, [(pointwise.lowered(G), i) for i in VECTOR]),
        **_loop("slopes", names, [(dF[x], i) for x, at in COMPONENTS.items() for i in at]),
        **_loop("bounded_slopes", names, [(diff(G, x), i) for x in (q, s) for i in MATRIX]),
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
    names = {symbol: "d_", **{constant: f"own[{i}]" for i, constant in enumerate(own.values())}}
    return HEAD.format(count=len(own)) + PRESSURE.format(
        **_loop("pressure", names, [(pointwise.lowered(p), ()), (pointwise.derivative(p, d), ())])
    )


def _loop(name: str, names: dict[Expr, str], outputs: list[tuple[Expr, tuple[int, ...]]]) -> dict[str, str | list[str]]:
    """Loop body, its results, and the results as entries of a row."""
    from wheelrail.forms.pointwise import straight_line

    lines, values = straight_line(names, outputs)
    row = _block(f"row[{j}] = {value};" for j, value in enumerate(values))
    return {name: _block(lines), f"{name}_out": values, f"{name}_row": row}


def _block(lines: Iterable[str]) -> str:
    return "\n".join(" " * 8 + line for line in lines)
