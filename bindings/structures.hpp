// Structures of the core as classes of Python: made from its fields, which stay alive with it, or returned by the core.
#pragma once
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/complex.h>

#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "support/core/owned.hpp"

namespace wr {

namespace nb = nanobind;

// Functions of the core run without the interpreter's lock.
using Unlocked = nb::call_guard<nb::gil_scoped_release>;

// Raises ValueError where arguments do not fit.
inline void require(bool fits, const char* text) {
    if (!fits) throw nb::value_error(text);
}

// Structure held by Python, with the objects of its origin or, if made by the core, the owners of its numbers.
struct Holder {
    nb::object given;
    Owners owners;
};
template <class T>
struct Kept : Holder {
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

// View of an array, held by Python for the time of use: of the same type, in C order, never a copy.
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
        return Held::from_cpp(wr::Kept<T>{{}, data}, rv_policy::move, cleanup);
    }
};

template <wr::Structure T>
struct type_caster<wr::Owned<T>> {
    using Held = make_caster<wr::Kept<T>>;
    static constexpr auto Name = Held::Name;

    static handle from_cpp(const wr::Owned<T>& owned, rv_policy, cleanup_list* cleanup) {
        return Held::from_cpp(wr::Kept<T>{{object(), owned.owners}, owned}, rv_policy::move, cleanup);
    }
};

}  // namespace nanobind::detail

namespace wr {

// Operations on fields of one type: taken from Python (false if of another type), returned to it, and named there.
struct FieldType {
    bool (*take)(nb::handle from, void* to);
    nb::object (*give)(const void* from, const Owners& owners);
    std::string (*name)(bool given);
};

// Text of nanobind about a type, with the names of classes for each %.
std::string python_name(std::string_view text, const std::type_info* const* types, bool given);

template <class F>
constexpr FieldType field_type{
    [](nb::handle from, void* to) {
        nb::detail::make_caster<F> caster;
        // Numbers of NumPy and integers count as numbers; anything else must have the right type.
        constexpr auto flags = std::is_arithmetic_v<F> ? uint8_t(nb::detail::cast_flags::convert) : uint8_t(0);
        if (!caster.from_python(from, flags, nullptr)) return false;
        if constexpr (Structure<F>)
            *static_cast<F*>(to) = *caster.value;
        else if constexpr (std::is_pointer_v<F>)  // of an object that Python holds
            *static_cast<F*>(to) = static_cast<std::remove_const_t<std::remove_pointer_t<F>>*>(caster);
        else
            *static_cast<F*>(to) = caster.value;
        return true;
    },
    [](const void* from, [[maybe_unused]] const Owners& owners) {
        const F& field = *static_cast<const F*>(from);
        if constexpr (Structure<F>)
            return nb::cast(Owned<F>(field, owners));
        else
            return nb::cast(field);
    },
    [](bool given) {
        constexpr auto text = nb::detail::make_caster<F>::Name;
        const std::type_info* types[text.type_count() + 1];
        text.put_types(types);
        return python_name(text.text, types, given) + (given && std::is_pointer_v<F> ? " | None" : "");
    }};

// Description of a structure for Python; code for its fields is the same for all structures but for two functions.
struct Description {
    std::string name;
    std::vector<const char*> fields;
    std::vector<const FieldType*> types;
    nb::handle type;
    const Holder& (*holder)(void* kept);
    const void* (*field)(void* kept, std::size_t number);

    // Raises TypeError that names the field.
    void take(const nb::tuple& given, void* const* to) const;
};

template <Structure T>
auto addresses(T& data) {
    return std::apply([](auto&... field) { return std::array{const_cast<void*>((const void*)&field)...}; },
                      data.fields());
}

// Names of the fields of a class, as of named tuples: it is made from their values, and pickled by them.
void set_fields(nb::handle made, std::span<const char* const> names);

// Class of a structure: its fields, read-only, copies and pickles by them. Text of what makes one.
std::string define(const Description* of, nb::handle made);

// Fields in order, given by position or by name.
nb::tuple ordered(const Description& of, const nb::args& first, const nb::kwargs& named);

// Class of a structure with the names of its fields. A structure with `bool fits() const` refuses lengths and indices
// that do not fit: the core reads within its arrays only.
template <Structure T, std::size_t N>
nb::class_<Kept<T>> structure(nb::module_& m, const char* name, const char* const (&fields)[N], const char* text = "") {
    nb::class_<Kept<T>> made(m, name, text);
    auto types = []<class... F>(std::type_identity<std::tuple<F&...>>) {
        static_assert(sizeof...(F) == N);
        return std::vector<const FieldType*>{&field_type<std::remove_const_t<F>>...};
    }(std::type_identity<decltype(std::declval<T&>().fields())>());
    const auto* of = new Description{
        name,
        {fields, fields + N},
        types,
        made,
        [](void* kept) -> const Holder& { return *static_cast<Kept<T>*>(kept); },
        [](void* kept, std::size_t i) -> const void* { return addresses(static_cast<Kept<T>*>(kept)->data)[i]; }};
    std::string init = define(of, made);
    made.def(
        "__init__",
        [of](Kept<T>* self, const nb::args& first, const nb::kwargs& named) {
            nb::tuple given = ordered(*of, first, named);
            T data;
            of->take(given, addresses(data).data());
            if constexpr (requires { data.fits(); })
                if (!data.fits()) throw nb::value_error((of->name + ": lengths or indices do not fit").c_str());
            new (self) Kept<T>{{given, {}}, std::move(data)};
        },
        nb::sig(init.c_str()));
    return made;
}

}  // namespace wr
