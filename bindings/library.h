/* What units in the library without Python need of it. */
enum { WHEELRAIL_INPUTS = 17, WHEELRAIL_OUTPUTS = 14, WHEELRAIL_FORCES = 12, WHEELRAIL_PATCH_VALUES = 13 };
#ifdef __cplusplus
extern "C" {
#endif
#include "export/functions.h"
/* Token, start values (17,) and friction coefficients (2,) of a unit, from its file in a folder. */
int wheelrail_unit(const char *folder, char token[64], double start[], double friction[]);
#ifdef __cplusplus
}
#endif

#ifndef __cplusplus
#define SCENE "contact.wheelset"
#endif
