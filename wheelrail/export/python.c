/* What Python needs inside programs that load the library with dlopen, and inside programs that run Python already. */
#include <dlfcn.h>
#include <limits.h>
#include <pthread.h>
#include <stdlib.h>

int wheelrail_python_open(const char *options, const char *folder);

static char library[PATH_MAX]; /* its file */
static int runs_python; /* the program, before it loaded the library */
static pthread_once_t once = PTHREAD_ONCE_INIT;

/* cffi takes the version tag of a type to be zero and uses it as a lock; in a running Python it may have been set. */
static void clear_lock(void)
{
    PyGILState_STATE state;
    if (!runs_python) return;
    state = PyGILState_Ensure();
    PyType_Modified(&PyCapsule_Type);
    PyGILState_Release(state);
}

/* Extension modules need the symbols of the library's libpython. */
__attribute__((constructor)) static void share_python(void)
{
    Dl_info own;
    if (dladdr((void *)share_python, &own) && !realpath(own.dli_fname, library)) *library = 0;
    dlopen(LIBPYTHON, RTLD_NOW | RTLD_GLOBAL);
    runs_python = Py_IsInitialized();
    clear_lock();
}

static const char *wheelrail_library(void) { return library; }

int wheelrail_version(void) { return WHEELRAIL_VERSION; }

int wheelrail_open(const char *options, const char *folder)
{
    pthread_once(&once, clear_lock);
    return wheelrail_python_open(options, folder);
}
