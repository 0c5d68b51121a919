// Python's face of laws of friction and pressure.
#include "contact/laws/core/law_library.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include <cmath>

#include "structures.hpp"

using namespace wr;
using namespace nanobind::literals;

namespace {

void require(bool fits) {
    if (!fits) throw nb::value_error("law: lengths or indices do not fit");
}

bool pairs(const Rows& a, long n) { return a.shape == std::array<long, 2>{2, n}; }

bool within(const Indices& index, long n) {
    for (long i : index)
        if (i < 0 || i >= n) return false;
    return true;
}

double norm(const View<double, 2>& F) {
    double total = 0.0;
    for (long i = 0; i < F.shape[1]; ++i) total += F(0, i) * F(0, i) + F(1, i) * F(1, i);
    return std::sqrt(total);
}

Array<double, 1> coefficient(const FrictionCode& code, Numbers w, Numbers p, Numbers own) {
    require(w.size() == p.size() && own.size() == code.parameters);
    Array<double, 1> mu(p.size());
    code.coefficient(p.size(), w.data, p.data, own.data, mu.data);
    return mu;
}

std::tuple<Array<double, 1>, Array<double, 2>, double> residual(const FrictionCode& code, Rows q, Rows s, Numbers p,
                                                                Numbers rho, double speed, double eps, Numbers own) {
    long n = p.size();
    require(pairs(q, n) && pairs(s, n) && rho.size() == n && own.size() == code.parameters);
    Array<double, 1> bound(n);
    Array<double, 2> F(2, n);
    code.residual(n, q.data, s.data, p.data, rho.data, speed, eps, own.data, bound.data, F.data);
    return {bound, F, norm(F)};
}

std::tuple<Array<double, 2>, double> bounded_residual(const FrictionCode& code, Rows q, Rows s, Numbers bound,
                                                      Numbers rho, double eps) {
    long n = bound.size();
    require(pairs(q, n) && pairs(s, n) && rho.size() == n);
    Array<double, 2> F(2, n);
    code.bounded_residual(n, q.data, s.data, bound.data, rho.data, eps, F.data);
    return {F, norm(F)};
}

Array<double, 2> slopes(const FrictionCode& code, Indices index, Rows q, Rows s, Numbers p, Numbers rho, double speed,
                        double eps, Numbers own) {
    long n = p.size();
    require(pairs(q, n) && pairs(s, n) && rho.size() == n && within(index, n) && own.size() == code.parameters);
    Array<double, 2> rows(index.size(), 12);
    code.slopes(index.size(), index.data, n, q.data, s.data, p.data, rho.data, speed, eps, own.data, rows.data);
    return rows;
}

Array<double, 2> bounded_slopes(const FrictionCode& code, Indices index, Rows q, Rows s, Numbers bound, Numbers rho,
                                double eps) {
    long n = bound.size();
    require(pairs(q, n) && pairs(s, n) && rho.size() == n && within(index, n));
    Array<double, 2> rows(index.size(), 12);
    code.bounded_slopes(index.size(), index.data, n, q.data, s.data, bound.data, rho.data, eps, rows.data);
    return rows;
}

std::tuple<Array<double, 1>, Array<double, 1>> pressure(const PressureCode& code, Numbers d, Numbers own) {
    require(own.size() == code.parameters);
    Array<double, 1> p(d.size()), slope(d.size());
    code.pressure(d.size(), d.data, own.data, p.data, slope.data);
    return {p, slope};
}

}  // namespace

void bind_laws(nb::module_& m) {
    nb::class_<FrictionCode>(m, "FrictionCode", "Functions of all friction laws of a class, from a library in C.")
        .def(
            "__init__",
            [](FrictionCode* self, const std::string& path) { new (self) FrictionCode(friction_code(path)); }, "path"_a)
        .def_ro("depends_on_speed", &FrictionCode::depends_on_speed)
        .def_ro("depends_on_pressure", &FrictionCode::depends_on_pressure)
        .def("coefficient", &coefficient, "w"_a, "p"_a, "parameters"_a, Unlocked())
        .def("residual", &residual, "q"_a, "s"_a, "p"_a, "rho"_a, "speed"_a, "eps"_a, "parameters"_a, Unlocked())
        .def("bounded_residual", &bounded_residual, "q"_a, "s"_a, "bound"_a, "rho"_a, "eps"_a, Unlocked())
        .def("slopes", &slopes, "index"_a, "q"_a, "s"_a, "p"_a, "rho"_a, "speed"_a, "eps"_a, "parameters"_a, Unlocked())
        .def("bounded_slopes", &bounded_slopes, "index"_a, "q"_a, "s"_a, "bound"_a, "rho"_a, "eps"_a, Unlocked());
    nb::class_<PressureCode>(m, "PressureCode", "Functions of all normal laws of a class, from a library in C.")
        .def(
            "__init__",
            [](PressureCode* self, const std::string& path) { new (self) PressureCode(pressure_code(path)); }, "path"_a)
        .def("pressure", &pressure, "d"_a, "parameters"_a, Unlocked());
    structure<ResidualCode>(m, "ResidualCode", {"code", "parameters", "regularisation"},
                            "A friction law of cells of strips: functions, constants and the creepage eps.");
    m.def(
        "friction_residual",
        [](const ResidualCode& law, Rows q, Rows s, Rows p, Numbers rho, double speed) {
            long n = rho.size();
            require(law.code && pairs(q, n) && pairs(s, n) && pairs(p, n));
            Array<double, 2> F(2, n);
            friction_residual(law, q, s, p, rho, speed, F);
            return F;
        },
        "law"_a, "q"_a, "s"_a, "p"_a, "rho"_a, "speed"_a, Unlocked(),
        "Means (2, n) Pa of the friction residual over cells, from tractions q (2, n) Pa, slips s (2, n) over the\n"
        "rolling speed m/s, pressures p (2, n) Pa at the ends, and rho (n,) 1/Pa.");
    m.def(
        "friction_slopes",
        [](const ResidualCode& law, Rows q, Rows s, Rows p, Numbers rho, double speed) {
            long n = rho.size();
            require(law.code && pairs(q, n) && pairs(s, n) && pairs(p, n));
            Array<double, 2> rows(n, 14);
            friction_slopes(law, q, s, p, rho, speed, rows);
            return rows;
        },
        "law"_a, "q"_a, "s"_a, "p"_a, "rho"_a, "speed"_a, Unlocked(),
        "Slopes (n, 14) of `friction_residual` by q, s (2, 2 each), both pressures and the speed (2 each).");
    m.def(
        "friction_bounds",
        [](const ResidualCode& law, Rows s, Numbers p, double speed) {
            require(law.code && pairs(s, p.size()));
            Array<double, 1> bounds(p.size());
            friction_bounds(law, s, p, speed, bounds);
            return bounds;
        },
        "law"_a, "s"_a, "p"_a, "speed"_a, Unlocked(),
        "Bounds (n,) Pa of the tractions at points with slips s (2, n) over the rolling speed m/s and pressures (n,) "
        "Pa.");
    m.def(
        "assembled_columns",
        [](Rows slopes, Rows slip, Rows pressure) {
            long k = slopes.size();
            require(slopes.shape[1] == 12 && slip.shape == std::array{2 * k, 2 * k} &&
                    (!pressure.size() || pressure.shape == std::array{k, 2 * k}));
            Array<double, 2> columns(2 * k, 2 * k);
            assembled(slopes, slip, pressure, columns);
            return columns;
        },
        "slopes"_a, "slip"_a, "pressure"_a, Unlocked(),
        "Columns of dF/dq (2 k, 2 k) as rows, from slopes (k, 12), ds/dq (2 k, 2 k) 1/Pa and dp/dq (k, 2 k) or (0, "
        "0).");
}
