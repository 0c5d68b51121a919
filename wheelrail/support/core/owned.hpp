// Structures of views with the memory that they see.
#pragma once
#include <memory>
#include <tuple>
#include <vector>

#include "support/core/arrays.hpp"

namespace wr {

template <class T>
concept HasFields = requires(T t) { t.fields(); };

using Owners = std::vector<std::shared_ptr<const void>>;

// A structure, and what owns the numbers of its views.
template <HasFields T>
struct Owned : T {
    Owners owners;

    Owned() = default;
    Owned(const T& data, Owners owners) : T(data), owners(std::move(owners)) {}
};

template <class T>
void own(T&, Owners&) {}
template <class T, int N>
void own(View<T, N>& view, Owners& owners) {
    auto copy = Array<std::remove_const_t<T>, N>::copy(view);
    owners.push_back(copy.owner);
    view = copy;
}
template <HasFields T>
void own(T& data, Owners& owners) {
    std::apply([&](auto&... field) { (own(field, owners), ...); }, data.fields());
}

// A copy with memory of its own.
template <HasFields T>
Owned<T> owned(const T& data) {
    Owned<T> copy(data, {});
    own(static_cast<T&>(copy), copy.owners);
    return copy;
}

// Some values, in order.
template <class T>
Array<T, 1> taken(const View<const T, 1>& values, const std::vector<long>& numbers) {
    Array<T, 1> some(long(numbers.size()));
    for (long k = 0; k < some.size(); ++k) some(k) = values(numbers[k]);
    return some;
}
template <class T>
Array<T, 1> taken(const Array<T, 1>& values, const std::vector<long>& numbers) {
    return taken(View<const T, 1>(values), numbers);
}

}  // namespace wr
