/* A host without Python: two instances of a unit at once, reset, freed and made again. */
#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

typedef void (*Logger)(void *, const char *, int, const char *, const char *, ...);
typedef struct {
    Logger logger;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *environment;
} Callbacks;
typedef void *(*Instantiate)(const char *, int, const char *, const char *, const Callbacks *, int, int);
typedef int (*Call)(void *);
typedef int (*Get)(void *, const unsigned[], size_t, double[]);
typedef int (*Set)(void *, const unsigned[], size_t, const double[]);
typedef int (*Derivative)(void *, const unsigned[], size_t, const unsigned[], size_t, const double[], double[]);
typedef int (*Step)(void *, double, double, int);

static void *library;
static const Callbacks *callbacks;
static const char *guid, *folder;
static const unsigned y_and_z[] = {0, 1}, yaw[] = {3}, friction[] = {200}, patch[] = {301};
static unsigned outputs[14];

static void log_text(void *environment, const char *name, int status, const char *category, const char *format, ...)
{
    va_list values;
    (void)environment, (void)category;
    va_start(values, format);
    printf("%s, status %d: ", name, status);
    vprintf(format, values);
    printf("\n");
    va_end(values);
}

static void *make(const char *name)
{
    return ((Instantiate)dlsym(library, "fmi2Instantiate"))(name, 1, guid, folder, callbacks, 0, 0);
}

static int call(const char *name, void *unit) { return ((Call)dlsym(library, name))(unit); }

static void place(void *unit, double y, double z)
{
    const double values[] = {y, z};
    double out[14], slope[12], area;
    const double one[] = {1.0};
    int k, status;
    ((Set)dlsym(library, "fmi2SetReal"))(unit, y_and_z, 2, values);
    status = ((Get)dlsym(library, "fmi2GetReal"))(unit, outputs, 14, out);
    if (status) { printf("status %d\n", status); return; }
    status = ((Derivative)dlsym(library, "fmi2GetDirectionalDerivative"))(unit, outputs, 12, yaw, 1, one, slope);
    status += ((Get)dlsym(library, "fmi2GetReal"))(unit, patch, 1, &area);
    status += ((Step)dlsym(library, "fmi2DoStep"))(unit, 0.0, 1e-3, 1);
    for (k = 0; k < 14; k++) printf("%a ", out[k]);
    for (k = 0; k < 12; k++) printf("%a ", slope[k]);
    printf("%a %d\n", area, status);
}

int main(int count, char **arguments)
{
    static const Callbacks with_logger = {log_text, calloc, free, NULL, NULL};
    const double low[] = {0.1}, negative[] = {-1.0};
    void *first, *second;
    unsigned k;
    if (count < 4 || !(library = dlopen(arguments[1], RTLD_NOW))) { printf("%s\n", dlerror()); return 1; }
    for (k = 0; k < 14; k++) outputs[k] = 100 + k;
    callbacks = &with_logger;
    folder = arguments[3];
    guid = "another";
    if (make("wrong")) return 1;
    guid = arguments[2];
    first = make("first");
    second = make("second");
    ((Set)dlsym(library, "fmi2SetReal"))(second, friction, 1, low);
    place(first, -1e-3, -2.8e-4);
    place(second, -1e-3, -2.8e-4);
    place(first, -1.2e-3, -2.7e-4);
    place(first, 0.0, 1.0);
    call("fmi2Reset", first);
    place(first, -1e-3, -2.8e-4);
    call("fmi2FreeInstance", first);
    call("fmi2FreeInstance", second);
    first = make("again");
    place(first, -1e-3, -2.8e-4);
    ((Set)dlsym(library, "fmi2SetReal"))(first, friction, 1, negative);
    place(first, -1e-3, -2.8e-4);
    call("fmi2FreeInstance", first);
    return 0;
}
