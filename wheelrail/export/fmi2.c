/* FMI 2.0 for model exchange and co-simulation, after unit.c. An accepted step is fmi2CompletedIntegratorStep or the
 * end of fmi2DoStep.
 */
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

static void log_text(const Unit *u, int status, const char *text)
{
    const fmi2CallbackFunctions *program = u->logger;
    if (program->logger) program->logger(program->environment, u->name, status, "logStatusError", "%s", text);
}

const char *fmi2GetTypesPlatform(void) { return "default"; }
const char *fmi2GetVersion(void) { return "2.0"; }

fmi2Component fmi2Instantiate(fmi2String name, int type, fmi2String guid, fmi2String folder,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging)
{
    (void)type, (void)visible, (void)logging;
    return make(name, guid, folder, (Unit){.log = log_text, .logger = callbacks});
}

void fmi2FreeInstance(fmi2Component c) { release(c); }
fmi2Status fmi2Reset(fmi2Component c) { return reset(c); }
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
    return set_numbers(c, vr, count, value);
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count, fmi2Real value[])
{
    return get_numbers(c, vr, count, value);
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t unknowns,
                                        const fmi2ValueReference known[], size_t knowns, const fmi2Real seed[],
                                        fmi2Real derivative[])
{
    return differentiate(c, unknown, unknowns, known, knowns, seed, derivative, 0);
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

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) { return get_state(c, state); }
fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) { return set_state(c, state); }
fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) { return free_state(c, state); }

/* What the unit does not have: variables of other types, states, events, interpolation of inputs, steps in the
 * background, serialised states. */
#define VR const fmi2ValueReference vr[], size_t count

fmi2Status fmi2GetInteger(fmi2Component c, VR, fmi2Integer v[]) { (void)vr, (void)v; return empty(c, count); }
fmi2Status fmi2GetBoolean(fmi2Component c, VR, fmi2Boolean v[]) { (void)vr, (void)v; return empty(c, count); }
fmi2Status fmi2GetString(fmi2Component c, VR, fmi2String v[]) { (void)vr, (void)v; return empty(c, count); }
fmi2Status fmi2SetInteger(fmi2Component c, VR, const fmi2Integer v[]) { (void)vr, (void)v; return empty(c, count); }
fmi2Status fmi2SetBoolean(fmi2Component c, VR, const fmi2Boolean v[]) { (void)vr, (void)v; return empty(c, count); }
fmi2Status fmi2SetString(fmi2Component c, VR, const fmi2String v[]) { (void)vr, (void)v; return empty(c, count); }
fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real v[], size_t count)
{
    (void)v;
    return empty(c, count);
}
fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real v[], size_t count) { (void)v; return empty(c, count); }
fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real v[], size_t count) { (void)v; return empty(c, count); }
fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real v[], size_t count) { (void)v; return empty(c, count); }
fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real v[], size_t count)
{
    (void)v;
    return empty(c, count);
}
fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, VR, const fmi2Integer order[], const fmi2Real v[])
{
    (void)vr, (void)order, (void)v;
    return empty(c, count);
}
fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, VR, const fmi2Integer order[], fmi2Real v[])
{
    (void)vr, (void)order, (void)v;
    return empty(c, count);
}
fmi2Status fmi2CancelStep(fmi2Component c) { return none(c); }
fmi2Status fmi2GetStatus(fmi2Component c, int kind, fmi2Status *v) { (void)kind, (void)v; return none(c); }
fmi2Status fmi2GetRealStatus(fmi2Component c, int kind, fmi2Real *v) { (void)kind, (void)v; return none(c); }
fmi2Status fmi2GetIntegerStatus(fmi2Component c, int kind, fmi2Integer *v) { (void)kind, (void)v; return none(c); }
fmi2Status fmi2GetBooleanStatus(fmi2Component c, int kind, fmi2Boolean *v) { (void)kind, (void)v; return none(c); }
fmi2Status fmi2GetStringStatus(fmi2Component c, int kind, fmi2String *v) { (void)kind, (void)v; return none(c); }
fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate s, size_t *size)
{
    (void)s, (void)size;
    return none(c);
}
fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate s, fmi2Byte bytes[], size_t size)
{
    (void)s, (void)bytes, (void)size;
    return none(c);
}
fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *s)
{
    (void)s, (void)bytes, (void)size;
    return none(c);
}
