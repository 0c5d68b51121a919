// Functions of wheelrail.h without Python.
#include <dlfcn.h>

#include "export/core/opened_elements.hpp"
#include "library.h"

using namespace wr;

namespace {

// Never destroyed: threads of the program may still run when it ends.
OpenedElements& all() {
    static auto* elements = new OpenedElements;
    return *elements;
}

const Variables& inputs_of_elements() {
    static const auto* variables = new Variables(input_variables());
    return *variables;
}

const Variables& outputs_of_elements() {
    static const auto* variables = new Variables(output_variables());
    return *variables;
}

// Folder of this library.
std::string own_folder() {
    Dl_info own;
    if (!dladdr(reinterpret_cast<void*>(&own_folder), &own) || !own.dli_fname) return "";
    std::string path = own.dli_fname;
    auto end = path.rfind('/');
    return end == std::string::npos ? "" : path.substr(0, end);
}

template <class T>
void copy(const T& from, double* to) {
    std::copy(from.begin(), from.end(), to);
}

static_assert(int(WHEELRAIL_INPUTS) == INPUTS && int(WHEELRAIL_OUTPUTS) == OUTPUTS && int(WHEELRAIL_FORCES) == FORCES &&
              int(WHEELRAIL_PATCH_VALUES) == PATCH_VALUES);

}  // namespace

extern "C" int wheelrail_version(void) { return INTERFACE; }

extern "C" int wheelrail_open(const char* options, const char* folder) {
    return all().open(options, folder, own_folder());
}

extern "C" int wheelrail_close(int element) { return all().close(element); }

extern "C" int wheelrail_start(int element, double inputs[]) {
    return all().with(element, [&](OpenElement& own) { copy(own.file->head.start, inputs); });
}

extern "C" int wheelrail_solve(int element, const double inputs[], double outputs[]) {
    return all().with(element, [&](OpenElement& own) {
        Numbers values{inputs, {INPUTS}};
        View<double, 1> filled{outputs, {OUTPUTS}};
        std::fill(filled.begin(), filled.end(), std::nan(""));
        own.element.forget();
        if (auto invalid = own.file->head.invalid(values); !invalid.empty())
            throw std::invalid_argument("failed: " + invalid);
        const auto& solution = own.element.solve(values);
        solution.store(filled);
        if (!solution.ok()) throw std::invalid_argument(solution.status());
    });
}

extern "C" int wheelrail_load(int element, int wheels, double load, double inputs[], double outputs[]) {
    return all().with(element, [&](OpenElement& own) {
        View<double, 1> values{inputs, {INPUTS}}, filled{outputs, {OUTPUTS}};
        std::fill(filled.begin(), filled.end(), std::nan(""));
        own.element.forget();
        const auto& head = own.file->head;
        if (wheels < LEFT_WHEEL || wheels > EACH_WHEEL)
            throw std::invalid_argument(
                text("load: wheels = %d: must be from %d to %d", wheels, LEFT_WHEEL, EACH_WHEEL));
        double each = wheels == BOTH_WHEELS ? 0.5 * load : load;
        if (!head.loads.allow(each))
            throw std::invalid_argument("load = " + shortest(load) + ": of a wheel must be " + head.loads.allowed);
        if (auto invalid = head.invalid(values); !invalid.empty()) throw std::invalid_argument("failed: " + invalid);
        double expected = sphere_approach(each, head.sphere[0], head.sphere[1]);
        const auto& solution = solve_under_load(own.element, LoadedWheels(wheels), load, expected, values);
        solution.store(filled);
        if (!solution.ok()) throw std::invalid_argument(solution.status());
    });
}

extern "C" int wheelrail_accept(int element) {
    return all().with(element, [](OpenElement& own) { own.element.accept(); });
}

extern "C" int wheelrail_tangent(int element, int input, double derivatives[]) {
    return all().with(element, [&](OpenElement& own) {
        if (input < 0 || input >= INPUTS)
            throw std::invalid_argument(text("tangent: input %d: must be from 0 to %d", input, INPUTS - 1));
        own.element.tangent(input, {derivatives, {FORCES}});
    });
}

extern "C" int wheelrail_patches(int element, double values[]) {
    return all().with(element, [&](OpenElement& own) { copy(own.element.patches(), values); });
}

extern "C" int wheelrail_save(int element, int place) {
    return all().with(element, [&](OpenElement& own) { own.states[place] = own.element.accepted(); });
}

extern "C" int wheelrail_restore(int element, int place) {
    return all().with(element, [&](OpenElement& own) {
        auto found = own.states.find(place);
        if (found == own.states.end())
            throw std::invalid_argument(text("restore: no state has been saved at %d", place));
        own.element.restore(found->second);
    });
}

extern "C" int wheelrail_input(const char* name) { return number_of(inputs_of_elements(), name); }
extern "C" int wheelrail_output(const char* name) { return number_of(outputs_of_elements(), name); }

extern "C" int wheelrail_error(int element, char* characters, int size) {
    if (size < 1) return FAILURE;
    auto reason = all().error(element);
    auto end = std::min(reason.size(), std::size_t(size - 1));
    while (end > 0 && end < reason.size() && (reason[end] & 0xC0) == 0x80) --end;  // whole characters of UTF-8
    reason.copy(characters, end);
    characters[end] = '\0';
    return DONE;
}

extern "C" int wheelrail_unit(const char* folder, char token[64], double start[], double friction[]) {
    return all().describe(folder, [&](const WheelsetHead& head) {
        token[head.token.copy(token, 63)] = '\0';
        copy(head.start, start);
        for (int side = 0; side < 2; ++side)
            friction[side] = std::isnan(head.friction[side]) ? 0.0 : head.friction[side];
    });
}
