// Libraries of laws of friction and pressure, compiled C.
#pragma once
#include <dlfcn.h>

#include <stdexcept>
#include <string>

#include "contact/laws/core/law.hpp"

namespace wr {

// A library that stays loaded until the process ends.
inline void* opened_library(const std::string& path) {
    void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!library) throw std::invalid_argument(dlerror());
    return library;
}

template <class T>
void find_symbol(void* library, const char* name, T*& found) {
    found = reinterpret_cast<T*>(dlsym(library, name));
    if (!found) throw std::invalid_argument(std::string("the library of a law has no ") + name);
}

inline long number_in(void* library, const char* name) {
    const long* at = nullptr;
    find_symbol(library, name, at);
    return *at;
}

inline FrictionCode friction_code(const std::string& path) {
    FrictionCode code;
    void* library = opened_library(path);
    find_symbol(library, "coefficient", code.coefficient);
    find_symbol(library, "residual", code.residual);
    find_symbol(library, "bounded_residual", code.bounded_residual);
    find_symbol(library, "slopes", code.slopes);
    find_symbol(library, "bounded_slopes", code.bounded_slopes);
    find_symbol(library, "mean_residual", code.mean_residual);
    find_symbol(library, "mean_slopes", code.mean_slopes);
    find_symbol(library, "bounds", code.bounds);
    code.parameters = number_in(library, "parameters");
    code.depends_on_speed = number_in(library, "depends_on_speed");
    code.depends_on_pressure = number_in(library, "depends_on_pressure");
    return code;
}

inline PressureCode pressure_code(const std::string& path) {
    PressureCode code;
    void* library = opened_library(path);
    find_symbol(library, "pressure", code.pressure);
    code.parameters = number_in(library, "parameters");
    return code;
}

}  // namespace wr
