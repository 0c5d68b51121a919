/* Units of FMI 3.0 in the library without Python. */
#include "unit.h"

#include "export/fmi3.c"
