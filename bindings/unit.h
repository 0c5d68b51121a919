/* What units of both versions of FMI have in the library without Python: what is particular to one is in its file. */
#define _POSIX_C_SOURCE 200809L
#include "library.h"
#include "export/unit.c"

static int constants(const char *folder, Constants *own)
{
    return wheelrail_unit(folder, own->token, own->in, own->parameter);
}
