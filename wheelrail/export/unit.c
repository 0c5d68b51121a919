/* A functional mock-up unit on the functions of wheelrail.h, for both versions of FMI; in one file after that header and
 * SCENE, the name of the unit's file among its resources, and before the function `constants`. The contact has no states
 * of its own: outputs are functions of inputs. Number of a variable: inputs from 0, outputs from OUT, parameters from
 * PARAMETER, patches of both sides from PATCH, and TIME. Functions return a status of FMI.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { OUT = 100, PARAMETER = 200, PATCH = 300, TIME = 400, STATES = 256, PARAMETERS = 2, INITIAL = STATES };
enum { OK, WARNING, DISCARD, ERROR }; /* of FMI 2.0 and 3.0 */

/* Of a unit: its token, and start values of inputs and parameters. */
typedef struct {
    char token[64];
    double in[WHEELRAIL_INPUTS], parameter[PARAMETERS];
} Constants;

static int constants(const char *folder, Constants *own);

static const char *const PARAMETER_NAME[] = {"left_friction", "right_friction"};

typedef struct Unit {
    Constants first;
    int element, solved;
    double time, in[WHEELRAIL_INPUTS], out[WHEELRAIL_OUTPUTS], parameter[PARAMETERS];
    char given[PARAMETERS], used[STATES]; /* parameters that were set; places of stored states */
    char *name, *folder;
    void (*log)(const struct Unit *, int status, const char *text);
    const void *logger, *environment; /* of the program */
} Unit;

typedef struct {
    int element, place; /* places are of one element: a closed one takes its stored states along */
    double time, in[WHEELRAIL_INPUTS], parameter[PARAMETERS];
    char given[PARAMETERS];
} Stored;

static int report(const Unit *u, int status, const char *text)
{
    char own[1000] = "the library could not be used";
    if (!text) {
        wheelrail_error(u->element, own, sizeof own);
        text = own;
    }
    if (u->logger) u->log(u, status, text);
    return status;
}

static void shut(Unit *u)
{
    if (u->element) wheelrail_close(u->element);
    u->element = u->solved = 0;
    memset(u->used, 0, sizeof u->used);
}

static int open_element(Unit *u)
{
    char options[300] = "{\"scene\": \"" SCENE "\"";
    int k;
    if (u->element) return OK;
    for (k = 0; k < PARAMETERS; k++)
        if (u->given[k])
            sprintf(options + strlen(options), ", \"%s\": %.17g", PARAMETER_NAME[k], u->parameter[k]);
    strcat(options, "}");
    u->element = wheelrail_open(options, u->folder);
    if (!u->element || wheelrail_save(u->element, INITIAL)) return report(u, ERROR, NULL);
    return OK;
}

static int solve(Unit *u)
{
    int status = open_element(u);
    if (status != OK || u->solved) return status;
    if (wheelrail_solve(u->element, u->in, u->out)) return report(u, DISCARD, NULL);
    u->solved = 1;
    return OK;
}

/* A step is complete: the next solves start from here. */
static int accept(Unit *u)
{
    int status = solve(u);
    if (status != OK) return status;
    return wheelrail_accept(u->element) ? report(u, ERROR, NULL) : OK;
}

static void start(Unit *u)
{
    u->time = 0.0;
    memcpy(u->in, u->first.in, sizeof u->in);
    memcpy(u->parameter, u->first.parameter, sizeof u->parameter);
    memset(u->given, 0, sizeof u->given);
}

static void release(Unit *u)
{
    if (!u) return;
    shut(u);
    free(u->name);
    free(u->folder);
    free(u);
}

/* A new unit, NULL for a wrong token. settings: log, logger and environment; folder: of the resources. */
static Unit *make(const char *name, const char *token, const char *folder, Unit settings)
{
    Unit *u = malloc(sizeof *u);
    if (!u) return NULL;
    *u = settings;
    u->name = strdup(name ? name : "");
    u->folder = strdup(folder ? folder : "");
    if (constants(u->folder, &u->first))
        report(u, ERROR, NULL);
    else if (!token || strcmp(token, u->first.token))
        report(u, ERROR, "the instantiation token (GUID) is not that of the unit");
    else {
        start(u);
        return u;
    }
    release(u);
    return NULL;
}

static int reset(Unit *u)
{
    int given = u->given[0] || u->given[1];
    start(u);
    u->solved = 0;
    if (given)
        shut(u);
    else if (u->element && wheelrail_restore(u->element, INITIAL))
        return report(u, ERROR, NULL);
    return OK;
}

static int set_numbers(Unit *u, const unsigned vr[], size_t count, const double value[])
{
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
            return report(u, ERROR, "set: not an input or a parameter");
    }
    return OK;
}

static int get_numbers(Unit *u, const unsigned vr[], size_t count, double value[])
{
    double patch[2 * WHEELRAIL_PATCH_VALUES];
    int status, has_patch = 0;
    size_t k;
    for (k = 0; k < count; k++) {
        if (vr[k] < WHEELRAIL_INPUTS)
            value[k] = u->in[vr[k]];
        else if (vr[k] == TIME)
            value[k] = u->time;
        else if (vr[k] >= PARAMETER && vr[k] < PARAMETER + PARAMETERS)
            value[k] = u->parameter[vr[k] - PARAMETER];
        else if (vr[k] >= OUT && vr[k] < OUT + WHEELRAIL_OUTPUTS) {
            if ((status = solve(u)) != OK) return status;
            value[k] = u->out[vr[k] - OUT];
        } else if (vr[k] >= PATCH && vr[k] < PATCH + 2 * WHEELRAIL_PATCH_VALUES) {
            if ((status = solve(u)) != OK) return status;
            if (!has_patch && wheelrail_patches(u->element, patch)) return report(u, ERROR, NULL);
            has_patch = 1;
            value[k] = patch[vr[k] - PATCH];
        } else
            return report(u, ERROR, "get: unknown variable");
    }
    return OK;
}

/* Derivatives of forces and moments by inputs, times a vector of the inputs, or of the forces if adjoint. */
static int differentiate(Unit *u, const unsigned unknown[], size_t unknowns, const unsigned known[], size_t knowns,
                         const double seed[], double derivative[], int adjoint)
{
    double column[WHEELRAIL_FORCES];
    int status = solve(u);
    size_t j, k;
    if (status != OK) return status;
    for (k = 0; k < unknowns; k++)
        if (unknown[k] < OUT || unknown[k] >= OUT + WHEELRAIL_FORCES)
            return report(u, ERROR, "derivatives: only forces and moments have them");
    for (k = 0; k < (adjoint ? knowns : unknowns); k++) derivative[k] = 0.0;
    for (j = 0; j < knowns; j++) {
        if (known[j] >= WHEELRAIL_INPUTS) return report(u, ERROR, "derivatives: not by an input");
        if (!adjoint && seed[j] == 0.0) continue;
        if (wheelrail_tangent(u->element, known[j], column)) return report(u, ERROR, NULL);
        for (k = 0; k < unknowns; k++)
            if (adjoint)
                derivative[j] += column[unknown[k] - OUT] * seed[k];
            else
                derivative[k] += column[unknown[k] - OUT] * seed[j];
    }
    return OK;
}

static int get_state(Unit *u, void **state)
{
    Stored *stored = *state;
    int place = 0, status = open_element(u);
    if (status != OK) return status;
    if (!stored || stored->element != u->element) {
        while (place < STATES && u->used[place]) place++;
        if (place == STATES || (!stored && !(stored = malloc(sizeof *stored))))
            return report(u, ERROR, "too many stored states");
        stored->element = u->element;
        stored->place = place;
        u->used[place] = 1;
        *state = stored;
    }
    stored->time = u->time;
    memcpy(stored->in, u->in, sizeof u->in);
    memcpy(stored->parameter, u->parameter, sizeof u->parameter);
    memcpy(stored->given, u->given, sizeof u->given);
    return wheelrail_save(u->element, stored->place) ? report(u, ERROR, NULL) : OK;
}

static int set_state(Unit *u, const Stored *stored)
{
    int status, place;
    if (stored->element != u->element) shut(u); /* its parameters may be others */
    u->time = stored->time;
    memcpy(u->in, stored->in, sizeof u->in);
    memcpy(u->parameter, stored->parameter, sizeof u->parameter);
    memcpy(u->given, stored->given, sizeof u->given);
    u->solved = 0;
    if ((status = open_element(u)) != OK) return status;
    place = stored->element == u->element ? stored->place : INITIAL;
    return wheelrail_restore(u->element, place) ? report(u, ERROR, NULL) : OK;
}

static int free_state(Unit *u, void **state)
{
    Stored *stored = *state;
    if (stored && stored->element == u->element) u->used[stored->place] = 0;
    free(stored);
    *state = NULL;
    return OK;
}

/* What a unit does not have, see its modelDescription.xml: `none` fails, `empty` does so where values are asked for. */
static int none(const Unit *u) { return report(u, ERROR, "not provided by this unit, see its modelDescription.xml"); }
static int empty(const Unit *u, size_t count) { return count ? none(u) : OK; }
