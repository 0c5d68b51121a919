// Structures of the core as classes of Python: made from its fields, which stay alive with it, or returned by the core.
#pragma once
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/complex.h>

#include <string>
#include <tuple>

#include "support/core/arrays.hpp"

namespace wr {

namespace nb = nanobind;

// Structures name their fields in order: auto fields() { return std::tie(first, second); }
template <class T>
concept Structure = requires(T t) { t.fields(); };

// Functions of the core run without the interpreter's lock.
using Unlocked = nb::call_guard<nb::gil_scoped_release>;

// Raises ValueError where arguments do not fit.
inline void require(bool fits, const char* text) {
    if (!fits) throw nb::value_error(text);
}

// What Python holds: a structure, and the objects from which it was made; none for one that the core made.
template <class T>
struct Kept {
    nb::object given;
    T data;
};

// Code of an element in Python's buffers.
template <class T>
bool is_code(const char* code) {
    using E = std::remove_const_t<T>;
    std::string_view c = code ? code : "B";
    if constexpr (std::is_same_v<E, double>) return c == "d";
    if constexpr (std::is_same_v<E, float>) return c == "f";
    if constexpr (std::is_same_v<E, bool>) return c == "?";
    if constexpr (std::is_same_v<E, int>) return c == "i";
    if constexpr (std::is_same_v<E, long>) return c == "l" || c == "q";
    if constexpr (std::is_same_v<E, std::complex<double>>) return c == "Zd";
    return false;
}

}  // namespace wr

namespace nanobind::detail {

// A view of an array that Python holds as long as it is used: of the same type, in C order, never a copy.
template <class T, int N>
struct type_caster<wr::View<T, N>> {
    using Numpy = ndarray<T, numpy, ndim<N>, c_contig, device::cpu>;
    using V = wr::View<T, N>;
    NB_TYPE_CASTER(V, make_caster<Numpy>::Name)

    bool from_python(handle source, uint32_t, cleanup_list*) noexcept {
        Py_buffer buffer;
        int flags = PyBUF_FORMAT | PyBUF_C_CONTIGUOUS | (std::is_const_v<T> ? 0 : PyBUF_WRITABLE);
        if (PyObject_GetBuffer(source.ptr(), &buffer, flags) != 0) {
            PyErr_Clear();
            return false;
        }
        bool right = buffer.ndim == N && wr::is_code<T>(buffer.format);
        if (right) {
            value.data = static_cast<T*>(buffer.buf);
            std::copy(buffer.shape, buffer.shape + N, value.shape.begin());
        }
        PyBuffer_Release(&buffer);
        return right;
    }
    static handle from_cpp(const V& view, rv_policy policy, cleanup_list* cleanup) {
        using Owner = wr::Array<std::remove_const_t<T>, N>;
        return make_caster<Owner>::from_cpp(Owner::copy(view), policy, cleanup);
    }
};

// An array of the core: Python shares its memory.
template <class T, int N>
struct type_caster<wr::Array<T, N>> {
    using Numpy = ndarray<T, numpy, ndim<N>, c_contig, device::cpu>;
    using A = wr::Array<T, N>;
    NB_TYPE_CASTER(A, make_caster<Numpy>::Name)

    bool from_python(handle source, uint32_t flags, cleanup_list* cleanup) noexcept {
        make_caster<wr::View<const T, N>> view;
        if (!view.from_python(source, flags, cleanup)) return false;
        value = A::copy(view.value);
        return true;
    }
    static handle from_cpp(const A& array, rv_policy, cleanup_list* cleanup) {
        auto* owner = new std::shared_ptr<T[]>(array.owner);
        capsule kept(owner, [](void* p) noexcept { delete static_cast<std::shared_ptr<T[]>*>(p); });
        std::size_t shape[N];
        std::copy(array.shape.begin(), array.shape.end(), shape);
        return make_caster<Numpy>::from_cpp(Numpy(array.data, N, shape, kept), rv_policy::reference, cleanup);
    }
};

template <wr::Structure T>
struct type_caster<T> {
    using Held = make_caster<wr::Kept<T>>;
    using Value = T;
    static constexpr auto Name = Held::Name;
    template <class>
    using Cast = T&;
    template <class>
    static constexpr bool can_cast() {
        return true;
    }
    T* value = nullptr;

    bool from_python(handle source, uint32_t flags, cleanup_list* cleanup) noexcept {
        Held held;
        if (!held.from_python(source, flags & ~uint32_t(cast_flags::convert), cleanup) || source.is_none())
            return false;
        value = &held.operator wr::Kept<T>&().data;
        return true;
    }
    explicit operator T&() { return *value; }
    static handle from_cpp(const T& data, rv_policy, cleanup_list* cleanup) {
        return Held::from_cpp(wr::Kept<T>{object(), data}, rv_policy::move, cleanup);
    }
};

}  // namespace nanobind::detail

namespace wr {

template <class F>
F field_of(nb::handle from, const std::string& structure, const char* name) {
    nb::detail::make_caster<F> caster;
    // Numbers of NumPy and integers count as numbers; anything else must have the right type.
    constexpr auto flags = std::is_arithmetic_v<F> ? uint8_t(nb::detail::cast_flags::convert) : uint8_t(0);
    if (!caster.from_python(from, flags, nullptr)) {
        std::string text = structure + "." + name + ": wrong type, or an array of other dimensions, numbers or order";
        throw nb::type_error(text.c_str());
    }
    if constexpr (Structure<F>)
        return *caster.value;
    else if constexpr (std::is_pointer_v<F>)  // of an object that Python holds
        return static_cast<std::remove_const_t<std::remove_pointer_t<F>>*>(caster);
    else
        return caster.value;
}

template <class T, std::size_t I>
using Field = std::decay_t<std::tuple_element_t<I, decltype(std::declval<T&>().fields())>>;

// Class of a structure with the names of its fields: made from them, read-only, pickled by them. A structure with
// `bool fits() const` refuses lengths and indices that do not fit: the core reads within its arrays only.
template <Structure T, std::size_t N>
nb::class_<Kept<T>> structure(nb::module_& m, const char* name, const char* const (&fields)[N], const char* text = "") {
    static_assert(std::tuple_size_v<decltype(std::declval<T&>().fields())> == N);
    nb::class_<Kept<T>> made(m, name, text);
    auto names = std::to_array(fields);
    auto define = [&]<std::size_t... I>(std::index_sequence<I...>) {
        made.def(
            "__init__",
            [own = std::string(name), names](Kept<T>* self, nb::typed<nb::object, Field<T, I>>... given) {
                T data;
                nb::object all[] = {given...};
                data.fields() = std::tuple{field_of<Field<T, I>>(all[I], own, names[I])...};
                if constexpr (requires { data.fits(); })
                    if (!data.fits()) throw nb::value_error((own + ": lengths or indices do not fit").c_str());
                new (self) Kept<T>{nb::make_tuple(given...), std::move(data)};
            },
            nb::arg(names[I]).none()...);
        (made.def_prop_ro(names[I],
                          [](Kept<T>& self) -> nb::typed<nb::object, Field<T, I>> {
                              if (self.given.is_valid()) return nb::typed<nb::object, Field<T, I>>(self.given[I]);
                              return nb::typed<nb::object, Field<T, I>>(nb::cast(std::get<I>(self.data.fields())));
                          }),
         ...);
    };
    define(std::make_index_sequence<N>());
    nb::list listed;
    for (const char* field : names) listed.append(field);
    made.attr("_fields") = nb::tuple(listed);
    made.def(
        "_replace",
        [names](nb::handle self, const nb::kwargs& changes) {
            nb::dict values;
            for (const char* field : names) values[field] = self.attr(field);
            values.update(changes);
            return self.type()(**values);
        },
        nb::sig("def _replace(self, **changes: object) -> typing.Self"),
        "The same with other fields, as of named tuples.");
    made.def("__reduce__", [names](nb::handle self) -> nb::typed<nb::tuple, nb::object, nb::object> {
        nb::list values;
        for (const char* field : names) values.append(self.attr(field));
        return nb::typed<nb::tuple, nb::object, nb::object>(nb::make_tuple(self.type(), nb::tuple(values)));
    });
    return made;
}

}  // namespace wr
