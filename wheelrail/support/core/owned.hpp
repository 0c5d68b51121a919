// Structures of views, with the memory behind the views.
#pragma once
#include <memory>
#include <tuple>
#include <vector>

#include "support/core/arrays.hpp"

namespace wr {

// Structures name their fields in order: auto fields() { return std::tie(first, second); }
template <class T>
concept Structure = requires(T t) { t.fields(); };

using Owners = std::vector<std::shared_ptr<const void>>;

// Structure with the owners of its views' numbers.
template <Structure T>
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
template <Structure T>
void own(T& data, Owners& owners) {
    std::apply([&](auto&... field) { (own(field, owners), ...); }, data.fields());
}

// A copy with memory of its own.
template <Structure T>
Owned<T> owned(const T& data) {
    Owned<T> copy(data, {});
    own(static_cast<T&>(copy), copy.owners);
    return copy;
}

// Owners, joined with the owners of some arrays.
template <class... A>
Owners owners_of(Owners owners, const A&... arrays) {
    (owners.push_back(arrays.owner), ...);
    return owners;
}

}  // namespace wr
