// Classes of structures, from their descriptions.
#include "structures.hpp"

#include <nanobind/stl/string.h>

namespace wr {

namespace {

void* instance(const Description& of, nb::handle self) {
    if (!PyObject_TypeCheck(self.ptr(), (PyTypeObject*)of.type.ptr()) || !nb::inst_ready(self))
        throw nb::type_error(("must be a " + of.name).c_str());
    return nb::inst_ptr<void>(self);
}

nb::object value(const Description& of, nb::handle self, std::size_t i) {
    void* kept = instance(of, self);
    const Holder& held = of.holder(kept);
    return held.given.is_valid() ? nb::object(held.given[i]) : of.types[i]->give(of.field(kept, i), held.owners);
}

}  // namespace

std::string python_name(std::string_view text, const std::type_info* const* types, bool given) {
    std::string name;
    for (std::size_t i = 0; i < text.size(); ++i)
        if (text[i] == '%') {
            nb::handle type = NB_CALL(nb_type_lookup)(NB_CTX, *types++);
            name += type.is_valid() ? nb::cast<std::string>(type.attr("__name__")) : "object";  // bound later
        } else if (text[i] == '@') {  // between three of them, the names of what is given and of what is returned
            std::size_t second = text.find('@', i + 1), third = text.find('@', second + 1);
            name += given ? text.substr(i + 1, second - i - 1) : text.substr(second + 1, third - second - 1);
            i = third;
        } else {
            name += text[i];
        }
    return name;
}

void Description::take(const nb::tuple& given, void* const* to) const {
    for (std::size_t i = 0; i < fields.size(); ++i)
        if (!types[i]->take(given[i], to[i]))
            throw nb::type_error(
                (name + "." + fields[i] + ": wrong type, or an array of other dimensions, numbers or order").c_str());
}

nb::tuple ordered(const Description& of, const nb::args& first, const nb::kwargs& named) {
    nb::list all(first);
    bool known = first.size() + named.size() == of.fields.size();
    for (std::size_t i = first.size(); known && i < of.fields.size(); ++i) {
        known = named.contains(of.fields[i]);
        if (known) all.append(named[of.fields[i]]);
    }
    if (known) return nb::tuple(all);
    std::string text = of.name + ": takes";
    for (const char* field : of.fields) text += std::string(" ") + field;
    throw nb::type_error(text.c_str());
}

void set_fields(nb::handle made, std::span<const char* const> names) {
    nb::list all;
    for (const char* name : names) all.append(name);
    nb::tuple fields(all);
    made.attr("_fields") = fields;
    nb::cpp_function_def(
        [fields](nb::handle self) {
            nb::list values;
            for (nb::handle name : fields) values.append(self.attr(name));
            return nb::make_tuple(self.type(), nb::tuple(values));
        },
        nb::is_method(), nb::scope(made), nb::name("__reduce__"),
        nb::sig("def __reduce__(self) -> tuple[object, object]"));
}

std::string define(const Description* of, nb::handle made) {
    std::string init = "def __init__(self";
    for (std::size_t i = 0; i < of->fields.size(); ++i) {
        const char* field = of->fields[i];
        std::string text = std::string("def ") + field + "(self) -> " + of->types[i]->name(false);
        made.attr(field) = nb::handle((PyObject*)&PyProperty_Type)(
            nb::cpp_function([of, i](nb::handle self) { return value(*of, self, i); }, nb::is_method(), nb::is_getter(),
                             nb::scope(made), nb::sig(text.c_str())));
        init += std::string(", ") + field + ": " + of->types[i]->name(true);
    }
    set_fields(made, of->fields);
    nb::cpp_function_def(
        [of](nb::handle self, const nb::kwargs& changes) {
            nb::dict all;
            for (std::size_t i = 0; i < of->fields.size(); ++i) all[of->fields[i]] = value(*of, self, i);
            all.update(changes);
            return self.type()(**all);
        },
        nb::is_method(), nb::scope(made), nb::name("_replace"),
        nb::sig("def _replace(self, **changes: object) -> typing.Self"),
        "The same with other fields, as of named tuples.");
    return init + ") -> None";
}

}  // namespace wr
