/* Units of FMI 2.0 in the library without Python. */
#include "unit.h"

#include "export/fmi2.c"
