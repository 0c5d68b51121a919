/* FMI 3.0 for model exchange and co-simulation, after unit.c. An accepted step is fmi3CompletedIntegratorStep or the
 * end of fmi3DoStep.
 */
#include <stdbool.h>
#include <stdint.h>

typedef void *fmi3Instance, *fmi3InstanceEnvironment, *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef double fmi3Float64;
typedef bool fmi3Boolean;
typedef const char *fmi3String;
typedef uint8_t fmi3Byte;
typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment, fmi3Status, fmi3String category, fmi3String message);
typedef void (*Callback)(void); /* one that is never called */

static void log_text(const Unit *u, int status, const char *text)
{
    ((fmi3LogMessageCallback)u->logger)((void *)u->environment, status, "logStatusError", text);
}

const char *fmi3GetVersion(void) { return "3.0"; }

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String folder, fmi3Boolean visible,
                                          fmi3Boolean logging, fmi3InstanceEnvironment environment,
                                          fmi3LogMessageCallback log_message)
{
    (void)visible, (void)logging;
    Unit settings = {.log = log_text, .logger = (const void *)log_message, .environment = environment};
    return make(name, token, folder, settings);
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String folder, fmi3Boolean visible,
                                         fmi3Boolean logging, fmi3Boolean events, fmi3Boolean early_return,
                                         const fmi3ValueReference intermediate[], size_t count,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback log_message,
                                         Callback intermediate_update)
{
    (void)events, (void)early_return, (void)intermediate, (void)count, (void)intermediate_update;
    return fmi3InstantiateModelExchange(name, token, folder, visible, logging, environment, log_message);
}

void fmi3FreeInstance(fmi3Instance c) { release(c); }
fmi3Status fmi3Reset(fmi3Instance c) { return reset(c); }
fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean has_tolerance, fmi3Float64 tolerance,
                                       fmi3Float64 from, fmi3Boolean has_end, fmi3Float64 to)
{
    (void)has_tolerance, (void)tolerance, (void)has_end, (void)to;
    ((Unit *)c)->time = from;
    return fmi3OK;
}
fmi3Status fmi3ExitInitializationMode(fmi3Instance c) { return open_element(c); }
fmi3Status fmi3Terminate(fmi3Instance c) { (void)c; return fmi3OK; }
fmi3Status fmi3EnterEventMode(fmi3Instance c) { (void)c; return fmi3OK; }
fmi3Status fmi3EnterStepMode(fmi3Instance c) { (void)c; return fmi3OK; }
fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance c) { (void)c; return fmi3OK; }
fmi3Status fmi3EnterConfigurationMode(fmi3Instance c) { (void)c; return fmi3OK; }
fmi3Status fmi3ExitConfigurationMode(fmi3Instance c) { (void)c; return fmi3OK; }
fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance c) { (void)c; return fmi3OK; }

fmi3Status fmi3SetTime(fmi3Instance c, fmi3Float64 time)
{
    ((Unit *)c)->time = time;
    return fmi3OK;
}

fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t count, const fmi3String categories[])
{
    (void)c, (void)on, (void)count, (void)categories;
    return fmi3OK;
}

/* All variables are scalars: there are as many values as variables. */
fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t count, const fmi3Float64 value[],
                          size_t values)
{
    return count == values ? set_numbers(c, vr, count, value) : none(c);
}

fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t count, fmi3Float64 value[],
                          size_t values)
{
    return count == values ? get_numbers(c, vr, count, value) : none(c);
}

#define DERIVATIVE(name, adjoint) \
    fmi3Status name(fmi3Instance c, const fmi3ValueReference unknown[], size_t unknowns, \
                    const fmi3ValueReference known[], size_t knowns, const fmi3Float64 seed[], size_t seeds, \
                    fmi3Float64 sensitivity[], size_t sensitivities) \
    { \
        if (seeds != (adjoint ? unknowns : knowns) || sensitivities != (adjoint ? knowns : unknowns)) return none(c); \
        return differentiate(c, unknown, unknowns, known, knowns, seed, sensitivity, adjoint); \
    }
DERIVATIVE(fmi3GetDirectionalDerivative, 0)
DERIVATIVE(fmi3GetAdjointDerivative, 1)

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance c, fmi3Boolean no_earlier, fmi3Boolean *event, fmi3Boolean *end)
{
    (void)no_earlier;
    *event = *end = false;
    return accept(c);
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 time, fmi3Float64 step, fmi3Boolean no_earlier, fmi3Boolean *event,
                      fmi3Boolean *end, fmi3Boolean *early_return, fmi3Float64 *last_time)
{
    int status = accept(c);
    (void)no_earlier;
    *event = *end = *early_return = false;
    *last_time = ((Unit *)c)->time = status == OK ? time + step : time;
    return status;
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *again, fmi3Boolean *end, fmi3Boolean *nominals,
                                    fmi3Boolean *values, fmi3Boolean *has_next, fmi3Float64 *next)
{
    (void)c;
    *again = *end = *nominals = *values = *has_next = false;
    *next = 0.0;
    return fmi3OK;
}

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *state) { return get_state(c, state); }
fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState state) { return set_state(c, state); }
fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *state) { return free_state(c, state); }

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance c, size_t *count) { (void)c; *count = 0; return fmi3OK; }
fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance c, size_t *count) { (void)c; *count = 0; return fmi3OK; }

/* What the unit does not have: variables of other types, states, clocks, scheduled execution, dependencies beyond those
 * of modelDescription.xml, serialised states. */
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#define VR const fmi3ValueReference vr[], size_t count
#define NO_VARIABLES(name, type) \
    fmi3Status fmi3Get##name(fmi3Instance c, VR, type v[], size_t n) { return empty(c, count); } \
    fmi3Status fmi3Set##name(fmi3Instance c, VR, const type v[], size_t n) { return empty(c, count); }
NO_VARIABLES(Float32, float)
NO_VARIABLES(Int8, int8_t)
NO_VARIABLES(UInt8, uint8_t)
NO_VARIABLES(Int16, int16_t)
NO_VARIABLES(UInt16, uint16_t)
NO_VARIABLES(Int32, int32_t)
NO_VARIABLES(UInt32, uint32_t)
NO_VARIABLES(Int64, int64_t)
NO_VARIABLES(UInt64, uint64_t)
NO_VARIABLES(Boolean, fmi3Boolean)
NO_VARIABLES(String, fmi3String)

#define NO_STATES(name, values) \
    fmi3Status fmi3##name(fmi3Instance c, values v[], size_t count) { return empty(c, count); }
NO_STATES(SetContinuousStates, const fmi3Float64)
NO_STATES(GetContinuousStates, fmi3Float64)
NO_STATES(GetContinuousStateDerivatives, fmi3Float64)
NO_STATES(GetNominalsOfContinuousStates, fmi3Float64)
NO_STATES(GetEventIndicators, fmi3Float64)

#define NONE(name, ...) fmi3Status fmi3##name(fmi3Instance c, __VA_ARGS__) { return none(c); }
fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String folder, fmi3Boolean visible,
                                               fmi3Boolean logging, fmi3InstanceEnvironment environment,
                                               fmi3LogMessageCallback log_message, Callback clock_update, Callback lock,
                                               Callback unlock)
{
    return NULL;
}
NONE(GetBinary, VR, size_t sizes[], const fmi3Byte *v[], size_t n)
NONE(SetBinary, VR, const size_t sizes[], const fmi3Byte *const v[], size_t n)
NONE(GetClock, VR, bool v[])
NONE(SetClock, VR, const bool v[])
NONE(GetNumberOfVariableDependencies, fmi3ValueReference dependent, size_t *count)
NONE(GetVariableDependencies, fmi3ValueReference dependent, size_t elements[],
     fmi3ValueReference independents[],
     size_t independent_elements[], int kinds[], size_t count)
NONE(GetOutputDerivatives, VR, const int32_t orders[], fmi3Float64 v[], size_t n)
NONE(GetIntervalDecimal, VR, fmi3Float64 intervals[], int qualifiers[])
NONE(GetIntervalFraction, VR, uint64_t counters[], uint64_t resolutions[], int qualifiers[])
NONE(GetShiftDecimal, VR, fmi3Float64 shifts[])
NONE(GetShiftFraction, VR, uint64_t counters[], uint64_t resolutions[])
NONE(SetIntervalDecimal, VR, const fmi3Float64 intervals[])
NONE(SetIntervalFraction, VR, const uint64_t counters[], const uint64_t resolutions[])
NONE(SetShiftDecimal, VR, const fmi3Float64 shifts[])
NONE(SetShiftFraction, VR, const uint64_t counters[], const uint64_t resolutions[])
NONE(ActivateModelPartition, fmi3ValueReference clock, fmi3Float64 time)
NONE(SerializedFMUStateSize, fmi3FMUState s, size_t *size)
NONE(SerializeFMUState, fmi3FMUState s, fmi3Byte bytes[], size_t size)
NONE(DeserializeFMUState, const fmi3Byte bytes[], size_t size, fmi3FMUState *s)
#pragma GCC diagnostic pop
