/* Version of the interface that the library has, WHEELRAIL_VERSION of its header. */
int wheelrail_version(void);
/* Number of a new element, 0 for a failure. options: JSON object, "friction", "left_friction" and "right_friction" are
 * coefficients. Without Python "scene" is an exported file in the folder, by default contact.wheelset in that of the
 * library; with Python it is a scene, the folder by default the working directory, and other options are arguments of
 * wheelrail.Wheelset. */
int wheelrail_open(const char *options, const char *folder);
int wheelrail_close(int element);
/* Inputs of the scene's state. */
int wheelrail_start(int element, double inputs[]);
/* Forces of a trial state, from the last accepted one; NaN on a side that failed. */
int wheelrail_solve(int element, const double inputs[], double outputs[]);
/* Solve the height, for WHEELRAIL_EACH and the roll, at which wheels carry a load in N. inputs: state to begin with, and
 * after it that under the load; outputs: forces there. */
int wheelrail_load(int element, int wheels, double load, double inputs[], double outputs[]);
/* The last solved state stands: the next solves start from it. */
int wheelrail_accept(int element);
/* Derivatives of the first WHEELRAIL_FORCES outputs by one input at the last solved state. */
int wheelrail_tangent(int element, int input, double derivatives[]);
/* WHEELRAIL_PATCH_VALUES values of the left, then as many of the right side, at the last solved state. */
int wheelrail_patches(int element, double values[]);
/* Store the accepted state at a place of your choice, and return to it. */
int wheelrail_save(int element, int place);
int wheelrail_restore(int element, int place);
/* Number of an input or output by name, -1 for an unknown one. */
int wheelrail_input(const char *name);
int wheelrail_output(const char *name);
/* Text of the last failure of an element, or of wheelrail_open for element 0; cut to size - 1 characters. */
int wheelrail_error(int element, char *text, int size);
