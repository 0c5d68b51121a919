/* What units in the library without Python need of it. */
enum { WHEELRAIL_INPUTS = 17, WHEELRAIL_OUTPUTS = 14, WHEELRAIL_FORCES = 12, WHEELRAIL_PATCH_VALUES = 13 };
#ifdef __cplusplus
extern "C" {
#endif
int wheelrail_open(const char *options, const char *folder);
int wheelrail_close(int element);
int wheelrail_solve(int element, const double inputs[], double outputs[]);
int wheelrail_accept(int element);
int wheelrail_tangent(int element, int input, double derivatives[]);
int wheelrail_patches(int element, double values[]);
int wheelrail_save(int element, int place);
int wheelrail_restore(int element, int place);
int wheelrail_error(int element, char *text, int size);
/* Token, start values (17,) and friction coefficients (2,) of a unit, from its file in a folder. */
int wheelrail_unit(const char *folder, char token[64], double start[], double friction[]);
#ifdef __cplusplus
}
#endif

#ifndef __cplusplus
#define SCENE "contact.wheelset"
#endif
