/* A host without Python: numbers of an element, of a second one in a thread, and what cannot be solved. */
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include "wheelrail.h"

static double place[3][2] = {{-1e-3, -2.8e-4}, {-1.2e-3, -2.7e-4}, {-1.4e-3, -2.6e-4}};
static const char *options;
static char texts[2][20000];

static void *path(void *text)
{
    double in[WHEELRAIL_INPUTS], out[WHEELRAIL_OUTPUTS], slope[WHEELRAIL_FORCES], patch[2 * WHEELRAIL_PATCH_VALUES];
    int k, n, element = wheelrail_open(options, NULL);
    char *end = text;
    if (wheelrail_start(element, in)) wheelrail_error(element, text, 300);
    else for (k = 0; k < 3; k++) {
        in[WHEELRAIL_IN_Y] = place[k][0];
        in[WHEELRAIL_IN_Z] = place[k][1];
        if (wheelrail_solve(element, in, out)) return wheelrail_error(element, end, 300), NULL;
        if (wheelrail_tangent(element, WHEELRAIL_IN_YAW, slope)) return NULL;
        if (wheelrail_patches(element, patch) || wheelrail_accept(element)) return NULL;
        for (n = 0; n < WHEELRAIL_OUTPUTS; n++) end += sprintf(end, "%a ", out[n]);
        for (n = 0; n < WHEELRAIL_FORCES; n++) end += sprintf(end, "%a ", slope[n]);
        for (n = 0; n < 2 * WHEELRAIL_PATCH_VALUES; n++) end += sprintf(end, "%a ", patch[n]);
        if (k == 0 && wheelrail_save(element, 7)) return NULL;
    }
    if (wheelrail_restore(element, 7) || wheelrail_solve(element, in, out) || wheelrail_close(element)) return NULL;
    return NULL;
}

static void wild(int element, const double start[], int input, double value)
{
    double in[WHEELRAIL_INPUTS], out[WHEELRAIL_OUTPUTS];
    char text[60];
    memcpy(in, start, sizeof in);
    in[input] = value;
    in[WHEELRAIL_IN_PITCH_RATE] = 0.0;
    if (!wheelrail_solve(element, in, out) || !isnan(out[0])) printf("solved ");
    wheelrail_error(element, text, sizeof text);
    printf("%s\n", text);
}

int main(int count, char **arguments)
{
    double start[WHEELRAIL_INPUTS], out[WHEELRAIL_OUTPUTS];
    pthread_t threads[2];
    char text[300];
    int k, element;
    if (count < 3 || wheelrail_version() != WHEELRAIL_VERSION) return 1;
    options = arguments[1];
    for (k = 0; k < 2; k++) pthread_create(&threads[k], NULL, path, texts[k]);
    for (k = 0; k < 2; k++) pthread_join(threads[k], NULL);
    printf("%s\n%s\n", texts[0], texts[1]);
    if (!(element = wheelrail_open(arguments[2], NULL)) || wheelrail_start(element, start)) return 1;
    start[WHEELRAIL_IN_Z] = -2.5e-4;
    wild(element, start, WHEELRAIL_IN_Z, NAN);
    wild(element, start, WHEELRAIL_IN_Z, -0.05);
    wild(element, start, WHEELRAIL_IN_SPEED, 0.0);
    wild(element, start, WHEELRAIL_IN_Y, 1e300);
    if (wheelrail_accept(element) != 1) return 1;
    if (wheelrail_solve(element, start, out) || wheelrail_accept(element)) return 1;
    if (wheelrail_load(element, WHEELRAIL_BOTH, 114e3, start, out) || wheelrail_accept(element)) return 1;
    printf("%.5e\n", out[WHEELRAIL_OUT_LEFT_FZ] + out[WHEELRAIL_OUT_RIGHT_FZ]);
    if (!wheelrail_load(element, WHEELRAIL_BOTH, -1.0, start, out) || !isnan(out[0])) return 1;
    for (k = 0; k < 3; k++) {
        static const char *const bad[] = {"{\"friction\": -1}", "{", "{\"scene\": \"none.toml\"}"};
        if (wheelrail_open(bad[k], NULL)) return 1;
        wheelrail_error(0, text, sizeof text);
        printf("%s\n", text);
    }
    printf("%d %d %d\n", wheelrail_input("yaw"), wheelrail_output("right_Mz"), wheelrail_input("speeed"));
    if (!wheelrail_tangent(element, 99, out) || !wheelrail_restore(element, 3)) return 1;
    if (wheelrail_close(element) || !wheelrail_close(element) || !wheelrail_solve(element, start, out)) return 1;
    wheelrail_error(element, text, sizeof text);
    printf("%s\n", text);
    return 0;
}
