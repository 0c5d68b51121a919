/* FMI 2.0 for model exchange and co-simulation on the functions of wheelrail.h; after that header and the generated
 * constants GUID, START, PARAMETER_START and PARAMETER_NAME in one file. The contact has no states of its own: outputs are
 * functions of inputs. An accepted step is fmi2CompletedIntegratorStep or the end of fmi2DoStep. Number of a variable:
 * inputs from 0, outputs from OUT, parameters from PARAMETER, patches of both sides from PATCH.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef void *fmi2Component, *fmi2ComponentEnvironment, *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer, fmi2Boolean;
typedef char fmi2Char, fmi2Byte;
typedef const fmi2Char *fmi2String;
typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef struct {
    void (*logger)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment environment;
} fmi2CallbackFunctions;
typedef struct {
    fmi2Boolean newDiscreteStatesNeeded, terminateSimulation, nominalsOfContinuousStatesChanged;
    fmi2Boolean valuesOfContinuousStatesChanged, nextEventTimeDefined;
    fmi2Real nextEventTime;
} fmi2EventInfo;

enum { OUT = 100, PARAMETER = 200, PATCH = 300, STATES = 256, PARAMETERS = 2, INITIAL = STATES };

typedef struct {
    int element, solved;
    double in[WHEELRAIL_INPUTS], out[WHEELRAIL_OUTPUTS], parameter[PARAMETERS];
    char given[PARAMETERS], used[STATES]; /* parameters that were set; places of stored states */
    char *name, *folder;
    const fmi2CallbackFunctions *callbacks;
} Unit;

typedef struct {
    int place;
    double in[WHEELRAIL_INPUTS];
} Stored;

static fmi2Status report(Unit *u, fmi2Status status, const char *text)
{
    char own[1000] = "Python or the package could not be loaded";
    if (!text) {
        wheelrail_error(u->element, own, sizeof own);
        text = own;
    }
    if (u->callbacks && u->callbacks->logger)
        u->callbacks->logger(u->callbacks->environment, u->name, status, "logStatusError", "%s", text);
    return status;
}

static void shut(Unit *u)
{
    if (u->element) wheelrail_close(u->element);
    u->element = u->solved = 0;
    memset(u->used, 0, sizeof u->used);
}

static fmi2Status open_element(Unit *u)
{
    char options[300] = "{\"scene\": \"scene.toml\"";
    int k;
    if (u->element) return fmi2OK;
    for (k = 0; k < PARAMETERS; k++)
        if (u->given[k])
            sprintf(options + strlen(options), ", \"%s\": %.17g", PARAMETER_NAME[k], u->parameter[k]);
    strcat(options, "}");
    u->element = wheelrail_open(options, u->folder);
    if (!u->element || wheelrail_save(u->element, INITIAL)) return report(u, fmi2Error, NULL);
    return fmi2OK;
}

static fmi2Status solve(Unit *u)
{
    fmi2Status status = open_element(u);
    if (status != fmi2OK || u->solved) return status;
    if (wheelrail_solve(u->element, u->in, u->out)) return report(u, fmi2Discard, NULL);
    u->solved = 1;
    return fmi2OK;
}

static fmi2Status accept(Unit *u)
{
    fmi2Status status = solve(u);
    if (status != fmi2OK) return status;
    return wheelrail_accept(u->element) ? report(u, fmi2Error, NULL) : fmi2OK;
}

static void start(Unit *u)
{
    memcpy(u->in, START, sizeof u->in);
    memcpy(u->parameter, PARAMETER_START, sizeof u->parameter);
    memset(u->given, 0, sizeof u->given);
}

const char *fmi2GetTypesPlatform(void) { return "default"; }
const char *fmi2GetVersion(void) { return "2.0"; }

void fmi2FreeInstance(fmi2Component c)
{
    Unit *u = c;
    if (!u) return;
    shut(u);
    free(u->name);
    free(u->folder);
    free(u);
}

fmi2Component fmi2Instantiate(fmi2String name, int type, fmi2String guid, fmi2String folder,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging)
{
    Unit *u = calloc(1, sizeof *u);
    (void)type, (void)visible, (void)logging;
    if (!u) return NULL;
    u->callbacks = callbacks;
    u->name = strdup(name ? name : "");
    u->folder = strdup(folder ? folder : "");
    start(u);
    if (!guid || strcmp(guid, GUID)) {
        report(u, fmi2Error, "the GUID is not that of the unit");
        fmi2FreeInstance(u);
        return NULL;
    }
    return u;
}

fmi2Status fmi2Reset(fmi2Component c)
{
    Unit *u = c;
    int given = u->given[0] || u->given[1];
    start(u);
    u->solved = 0;
    if (given)
        shut(u);
    else if (u->element && wheelrail_restore(u->element, INITIAL))
        return report(u, fmi2Error, NULL);
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) { return open_element(c); }
fmi2Status fmi2EnterInitializationMode(fmi2Component c) { (void)c; return fmi2OK; }
fmi2Status fmi2Terminate(fmi2Component c) { (void)c; return fmi2OK; }
fmi2Status fmi2EnterEventMode(fmi2Component c) { (void)c; return fmi2OK; }
fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c) { (void)c; return fmi2OK; }
fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time) { (void)c, (void)time; return fmi2OK; }

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real from,
                               fmi2Boolean has_end, fmi2Real to)
{
    (void)c, (void)has_tolerance, (void)tolerance, (void)from, (void)has_end, (void)to;
    return fmi2OK;
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t count, const fmi2String categories[])
{
    (void)c, (void)on, (void)count, (void)categories;
    return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count, const fmi2Real value[])
{
    Unit *u = c;
    size_t k;
    for (k = 0; k < count; k++) {
        if (vr[k] < WHEELRAIL_INPUTS) {
            u->solved = u->solved && u->in[vr[k]] == value[k];
            u->in[vr[k]] = value[k];
        } else if (vr[k] >= PARAMETER && vr[k] < PARAMETER + PARAMETERS) {
            shut(u);
            u->parameter[vr[k] - PARAMETER] = value[k];
            u->given[vr[k] - PARAMETER] = 1;
        } else
            return report(u, fmi2Error, "fmi2SetReal: not an input or a parameter");
    }
    return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count, fmi2Real value[])
{
    Unit *u = c;
    fmi2Status status;
    double patch[2 * WHEELRAIL_PATCH_VALUES];
    int has_patch = 0;
    size_t k;
    for (k = 0; k < count; k++) {
        if (vr[k] < WHEELRAIL_INPUTS)
            value[k] = u->in[vr[k]];
        else if (vr[k] >= PARAMETER && vr[k] < PARAMETER + PARAMETERS)
            value[k] = u->parameter[vr[k] - PARAMETER];
        else if (vr[k] >= OUT && vr[k] < OUT + WHEELRAIL_OUTPUTS) {
            if ((status = solve(u)) != fmi2OK) return status;
            value[k] = u->out[vr[k] - OUT];
        } else if (vr[k] >= PATCH && vr[k] < PATCH + 2 * WHEELRAIL_PATCH_VALUES) {
            if ((status = solve(u)) != fmi2OK) return status;
            if (!has_patch && wheelrail_patches(u->element, patch)) return report(u, fmi2Error, NULL);
            has_patch = 1;
            value[k] = patch[vr[k] - PATCH];
        } else
            return report(u, fmi2Error, "fmi2GetReal: unknown variable");
    }
    return fmi2OK;
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t unknowns,
                                        const fmi2ValueReference known[], size_t knowns, const fmi2Real seed[],
                                        fmi2Real derivative[])
{
    Unit *u = c;
    double column[WHEELRAIL_FORCES];
    fmi2Status status = solve(u);
    size_t j, k;
    if (status != fmi2OK) return status;
    for (k = 0; k < unknowns; k++) {
        if (unknown[k] < OUT || unknown[k] >= OUT + WHEELRAIL_FORCES)
            return report(u, fmi2Error, "fmi2GetDirectionalDerivative: only forces and moments have derivatives");
        derivative[k] = 0.0;
    }
    for (j = 0; j < knowns; j++) {
        if (known[j] >= WHEELRAIL_INPUTS) return report(u, fmi2Error, "fmi2GetDirectionalDerivative: not an input");
        if (seed[j] == 0.0) continue;
        if (wheelrail_tangent(u->element, known[j], column)) return report(u, fmi2Error, NULL);
        for (k = 0; k < unknowns; k++) derivative[k] += column[unknown[k] - OUT] * seed[j];
    }
    return fmi2OK;
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean no_earlier, fmi2Boolean *event, fmi2Boolean *end)
{
    (void)no_earlier;
    *event = *end = 0;
    return accept(c);
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_earlier)
{
    (void)time, (void)step, (void)no_earlier;
    return accept(c);
}

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info)
{
    (void)c;
    memset(info, 0, sizeof *info);
    return fmi2OK;
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    Unit *u = c;
    Stored *stored = *state;
    fmi2Status status = open_element(u);
    int place = 0;
    if (status != fmi2OK) return status;
    if (!stored) {
        while (place < STATES && u->used[place]) place++;
        if (place == STATES || !(stored = malloc(sizeof *stored)))
            return report(u, fmi2Error, "fmi2GetFMUstate: too many stored states");
        stored->place = place;
        u->used[place] = 1;
        *state = stored;
    }
    memcpy(stored->in, u->in, sizeof u->in);
    return wheelrail_save(u->element, stored->place) ? report(u, fmi2Error, NULL) : fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
    Unit *u = c;
    Stored *stored = state;
    fmi2Status status = open_element(u);
    if (status != fmi2OK) return status;
    memcpy(u->in, stored->in, sizeof u->in);
    u->solved = 0;
    return wheelrail_restore(u->element, stored->place) ? report(u, fmi2Error, NULL) : fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    Unit *u = c;
    Stored *stored = *state;
    if (stored) u->used[stored->place] = 0;
    free(stored);
    *state = NULL;
    return fmi2OK;
}

/* What the unit does not have: variables of other types, states, events, interpolation of inputs, steps in the
 * background, serialised states. */
#define NONE(u) return report(u, fmi2Error, "not provided by this unit, see its modelDescription.xml")
#define EMPTY(u, count) do { (void)(u); if (count) NONE(u); return fmi2OK; } while (0)
#define VR const fmi2ValueReference vr[], size_t count

fmi2Status fmi2GetInteger(fmi2Component c, VR, fmi2Integer v[]) { (void)vr, (void)v; EMPTY(c, count); }
fmi2Status fmi2GetBoolean(fmi2Component c, VR, fmi2Boolean v[]) { (void)vr, (void)v; EMPTY(c, count); }
fmi2Status fmi2GetString(fmi2Component c, VR, fmi2String v[]) { (void)vr, (void)v; EMPTY(c, count); }
fmi2Status fmi2SetInteger(fmi2Component c, VR, const fmi2Integer v[]) { (void)vr, (void)v; EMPTY(c, count); }
fmi2Status fmi2SetBoolean(fmi2Component c, VR, const fmi2Boolean v[]) { (void)vr, (void)v; EMPTY(c, count); }
fmi2Status fmi2SetString(fmi2Component c, VR, const fmi2String v[]) { (void)vr, (void)v; EMPTY(c, count); }
fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real v[], size_t count) { (void)v; EMPTY(c, count); }
fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real v[], size_t count) { (void)v; EMPTY(c, count); }
fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real v[], size_t count) { (void)v; EMPTY(c, count); }
fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real v[], size_t count) { (void)v; EMPTY(c, count); }
fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real v[], size_t count) { (void)v; EMPTY(c, count); }
fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, VR, const fmi2Integer order[], const fmi2Real v[])
{
    (void)vr, (void)order, (void)v;
    EMPTY(c, count);
}
fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, VR, const fmi2Integer order[], fmi2Real v[])
{
    (void)vr, (void)order, (void)v;
    EMPTY(c, count);
}
fmi2Status fmi2CancelStep(fmi2Component c) { NONE(c); }
fmi2Status fmi2GetStatus(fmi2Component c, int kind, fmi2Status *v) { (void)kind, (void)v; NONE(c); }
fmi2Status fmi2GetRealStatus(fmi2Component c, int kind, fmi2Real *v) { (void)kind, (void)v; NONE(c); }
fmi2Status fmi2GetIntegerStatus(fmi2Component c, int kind, fmi2Integer *v) { (void)kind, (void)v; NONE(c); }
fmi2Status fmi2GetBooleanStatus(fmi2Component c, int kind, fmi2Boolean *v) { (void)kind, (void)v; NONE(c); }
fmi2Status fmi2GetStringStatus(fmi2Component c, int kind, fmi2String *v) { (void)kind, (void)v; NONE(c); }
fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate s, size_t *size) { (void)s, (void)size; NONE(c); }
fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate s, fmi2Byte bytes[], size_t size)
{
    (void)s, (void)bytes, (void)size;
    NONE(c);
}
fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *s)
{
    (void)s, (void)bytes, (void)size;
    NONE(c);
}
