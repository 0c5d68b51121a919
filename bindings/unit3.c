/* Units of FMI 3.0 in the library without Python: what is particular to one is in its file. */
#define _POSIX_C_SOURCE 200809L
#include "library.h"
#include "export/unit.c"

static int constants(const char *folder, Constants *own)
{
    return wheelrail_unit(folder, own->token, own->in, own->parameter);
}

#include "export/fmi3.c"
