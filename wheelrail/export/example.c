/* A wheelset that drops onto its rails, one implicit Euler step after the other.
 *
 *     cc example.c -L. -lwheelrail -Wl,-rpath,'$ORIGIN' -lm -o example && ./example '{"friction": 0.3}'
 */
#include <math.h>
#include <stdio.h>
#include "wheelrail.h"

static int report(int element, const char *what)
{
    char text[500] = "the library could not be used";
    wheelrail_error(element, text, sizeof text);
    fprintf(stderr, "%s: %s\n", what, text);
    return 1;
}

int main(int count, char **arguments)
{
    const double mass = 1200.0, weight = 160e3, h = 2e-4, touching = -2e-4; /* kg, N, s, m */
    double in[WHEELRAIL_INPUTS], out[WHEELRAIL_OUTPUTS], slope[WHEELRAIL_FORCES];
    double z = touching, z_rate = 0.0, trial, lift, residual, before, lift_before, stiffness = 1e9;
    int step, iteration, element = wheelrail_open(count > 1 ? arguments[1] : "{}", count > 2 ? arguments[2] : NULL);
    if (!element) return report(0, "open");
    if (wheelrail_start(element, in)) return report(element, "start");
    for (step = 0; step < 5; step++) {
        trial = z + h * z_rate;
        lift_before = before = 0.0;
        for (iteration = 0; iteration < 50; iteration++) {
            in[WHEELRAIL_IN_Z] = trial;
            in[WHEELRAIL_IN_Z_RATE] = (trial - z) / h;
            if (wheelrail_solve(element, in, out)) return report(element, "solve");
            lift = out[WHEELRAIL_OUT_LEFT_FZ] + out[WHEELRAIL_OUT_RIGHT_FZ];
            residual = mass * (trial - z - h * z_rate) / (h * h) + weight - lift;
            if (fabs(residual) < 1e-6 * weight) break;
            if (!wheelrail_tangent(element, WHEELRAIL_IN_Z, slope)) /* Polach's formula has none */
                stiffness = -slope[WHEELRAIL_OUT_LEFT_FZ] - slope[WHEELRAIL_OUT_RIGHT_FZ];
            else if (iteration > 0 && trial != before)
                stiffness = -(lift - lift_before) / (trial - before);
            before = trial, lift_before = lift;
            trial -= residual / (mass / (h * h) + stiffness);
        }
        if (wheelrail_accept(element)) return report(element, "accept");
        z_rate = (trial - z) / h;
        z = trial;
    }
    for (step = 0; step < WHEELRAIL_OUTPUTS; step++) printf("%.17g\n", out[step]);
    fprintf(stderr, "%.4f mm, %.1f kN\n", 1e3 * z, 1e-3 * lift);
    return wheelrail_close(element);
}
