"""Stored states of a unit, by its C code with a contact that remembers one number in place of the library."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from wheelrail.export.header import c_header
from wheelrail.export.model_description import UnitModel
from wheelrail.export.unit import _source

if shutil.which("cc") is None:
    pytest.skip("no C compiler", allow_module_level=True)

# Elements whose accepted state is the last solved y; out[0] is that state, out[1] the friction of the left wheel.
CONTACT = """
#include <stdio.h>
#include <string.h>
static int count;
static double accepted[99], solved[99], saved[99][300], friction[99];
int wheelrail_open(const char *options, const char *folder)
{
    const char *given = strstr(options, "left_friction");
    (void)folder;
    friction[++count] = 0.3;
    if (given) sscanf(given, "left_friction\\": %lf", friction + count);
    return count;
}
int wheelrail_close(int e) { (void)e; return 0; }
int wheelrail_solve(int e, const double in[], double out[])
{
    solved[e] = in[0]; out[0] = accepted[e]; out[1] = friction[e]; return 0;
}
int wheelrail_accept(int e) { accepted[e] = solved[e]; return 0; }
int wheelrail_tangent(int e, int i, double d[]) { (void)e, (void)i, (void)d; return 1; }
int wheelrail_patches(int e, double v[]) { (void)e, (void)v; return 1; }
int wheelrail_save(int e, int place) { saved[e][place] = accepted[e]; return 0; }
int wheelrail_restore(int e, int place) { accepted[e] = saved[e][place]; return 0; }
int wheelrail_error(int e, char *text, int size) { (void)e, (void)size; *text = 0; return 0; }
"""
PROGRAM = """
static fmi2Component unit;
static const fmi2ValueReference y[] = {0}, mu[] = {200}, out[] = {100, 101};
static void step(double value)
{
    double o[2];
    fmi2SetReal(unit, y, 1, &value);
    fmi2GetReal(unit, out, 2, o);
    fmi2DoStep(unit, 0.0, 1.0, 1);
}
static void show(void)
{
    double in[1], o[2];
    fmi2GetReal(unit, y, 1, in);
    fmi2GetReal(unit, out, 2, o);
    printf("%g %g %g\\n", in[0], o[0], o[1]);
}
int main(void)
{
    static const fmi2CallbackFunctions none;
    static const double low[] = {0.1};
    fmi2FMUstate first = NULL, second = NULL, third = NULL;
    unit = fmi2Instantiate("unit", 1, "token", "", &none, 0, 0);
    step(1.0);
    fmi2GetFMUstate(unit, &first);
    fmi2SetReal(unit, mu, 1, low); /* opens another element */
    step(2.0);
    fmi2GetFMUstate(unit, &second);
    fmi2FreeFMUstate(unit, &first); /* of the former element: its place is that of the second state there */
    step(3.0);
    fmi2GetFMUstate(unit, &third);
    fmi2SetFMUstate(unit, second);
    show();
    fmi2SetFMUstate(unit, third);
    show();
    fmi2Reset(unit);
    fmi2GetFMUstate(unit, &first);
    fmi2SetFMUstate(unit, second); /* y and friction, in an element that starts anew */
    show();
    fmi2SetFMUstate(unit, first);
    show();
    fmi2FreeFMUstate(unit, &first);
    fmi2FreeFMUstate(unit, &second);
    fmi2FreeFMUstate(unit, &third);
    fmi2FreeInstance(unit);
    return 0;
}
"""


def test_states_have_places_and_parameters_of_their_own(tmp_path: Path) -> None:
    """Values are y, accepted state and friction: each state has those at which it was stored."""
    model = UnitModel("2.0", "unit", "token", "0", [0.5] * 17, (0.3, 0.3), has_tangent=True)
    (tmp_path / "unit.c").write_text("\n".join([c_header(), CONTACT, _source(model), PROGRAM]))
    line = ["cc", "-Wall", "-Werror", "-Wno-unused-function", "-g", "unit.c", "-o", "program"]
    subprocess.run(line, cwd=tmp_path, check=True, timeout=60)
    done = subprocess.run([tmp_path / "program"], capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout.splitlines() == ["2 2 0.1", "3 3 0.1", "2 0 0.1", "0.5 0 0.3"]
