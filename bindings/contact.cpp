// The module of contact: curves and surfaces, laws, contact models, results.
#include <nanobind/nanobind.h>

namespace nb = nanobind;

void bind_curves(nb::module_& m);
void bind_geometry(nb::module_& m);
void bind_kinematics(nb::module_& m);
void bind_laws(nb::module_& m);
void bind_influence(nb::module_& m);
void bind_tables(nb::module_& m);
void bind_lattice(nb::module_& m);
void bind_derivatives(nb::module_& m);
void bind_lattice_problem(nb::module_& m);
void bind_lattice_contact(nb::module_& m);
void bind_standard(nb::module_& m);
void bind_results(nb::module_& m);
void bind_table(nb::module_& m);
void bind_loading(nb::module_& m);
void bind_element(nb::module_& m);

NB_MODULE(_contact, m) {
    nb::set_leak_warnings(false);  // what Python keeps until its end is no leak
    bind_curves(m);
    bind_kinematics(m);
    bind_geometry(m);
    bind_laws(m);
    bind_results(m);
    bind_influence(m);
    bind_tables(m);
    bind_lattice(m);
    bind_derivatives(m);
    bind_lattice_problem(m);
    bind_lattice_contact(m);
    bind_standard(m);
    bind_table(m);
    bind_loading(m);
    bind_element(m);
}
