// Arrays of numbers in C order: views of memory that somebody else owns, and arrays that own it.
#pragma once
#include <algorithm>
#include <array>
#include <cstdlib>
#include <memory>
#include <new>
#include <vector>

#if defined(_GLIBCXX_ASSERTIONS)
#include <stdexcept>
#endif

namespace wr {

// A view of N dimensions; a row of it is one of N - 1. Builds with sanitizers check every index.
template <class T, int N>
struct View {
    T* data = nullptr;
    std::array<long, N> shape{};

    operator View<const T, N>() const { return {data, shape}; }

    template <class... I>
    T& operator()(I... index) const {
        static_assert(sizeof...(I) == N);
        long at = 0;
        int k = 0;
        ((at = at * shape[k] + checked(long(index), k), ++k), ...);
        return data[at];
    }
    // An element, or a row.
    decltype(auto) operator[](long i) const {
        if constexpr (N == 1) {
            return (*this)(i);
        } else {
            View<T, N - 1> row{data + checked(i, 0) * stride(), {}};
            std::copy(shape.begin() + 1, shape.end(), row.shape.begin());
            return row;
        }
    }
    // Rows, or elements, from the first to before the last.
    View part(long first, long last) const {
        View v = *this;
        v.data += first * stride();
        v.shape[0] = last - first;
        return v;
    }
    long size() const { return shape[0]; }
    long count() const { return shape[0] * stride(); }
    T* begin() const { return data; }
    T* end() const { return data + count(); }

  private:
    // Elements of a row.
    long stride() const {
        long n = 1;
        for (int k = 1; k < N; ++k) n *= shape[k];
        return n;
    }
    long checked(long i, [[maybe_unused]] int k) const {
#if defined(_GLIBCXX_ASSERTIONS)
        if (i < 0 || i >= shape[k]) throw std::out_of_range("index of an array");
#endif
        return i;
    }
};

// An array that owns its numbers, zero at first; a copy shares them. It begins at a line of the cache: vectors of eight
// then lie in one, otherwise in two, which takes up to a third longer to read.
template <class T, int N>
struct Array : View<T, N> {
    std::shared_ptr<T[]> owner;

    Array() = default;
    explicit Array(const std::array<long, N>& sizes) {
        this->shape = sizes;
        // of calloc: large ones take zeros of the system
        constexpr std::size_t line = 64;
        std::size_t size = sizeof(T) * std::size_t(this->count()), room = size + line;
        void* whole = std::calloc(1, room);
        if (!whole) throw std::bad_alloc();
        void* first = whole;
        owner.reset(static_cast<T*>(std::align(line, size, first, room)), [whole](T*) { std::free(whole); });
        this->data = owner.get();
    }
    template <class... I>
        requires(sizeof...(I) == N)
    explicit Array(I... sizes) : Array(std::array<long, N>{long(sizes)...}) {}

    // Array with unset numbers, and array of zeros without memory until a change.
    static Array unset(const std::array<long, N>& sizes) {
        Array a;
        a.shape = sizes;
        constexpr std::align_val_t line{64};
        a.owner.reset(new (line) T[a.count()], [](T* p) { ::operator delete[](p, line); });
        a.data = a.owner.get();
        return a;
    }
    static Array sparse(const std::array<long, N>& sizes) {
        Array a;
        a.shape = sizes;
        auto* zeros = static_cast<T*>(std::calloc(std::max(a.count(), 1L), sizeof(T)));
        if (!zeros) throw std::bad_alloc();
        a.owner.reset(zeros, [](T* p) { std::free(p); });
        a.data = zeros;
        return a;
    }
    static Array copy(const View<const T, N>& from) {
        Array a = unset(from.shape);
        std::copy(from.begin(), from.end(), a.begin());
        return a;
    }
};

using Numbers = View<const double, 1>;
using Rows = View<const double, 2>;
using Blocks = View<const double, 3>;
using Indices = View<const long, 1>;

// Numbers of the true values of a mask.
template <class M>
std::vector<long> numbers_of(const M& mask) {
    std::vector<long> numbers;
    long k = 0;
    for (bool one : mask) {
        if (one) numbers.push_back(k);
        ++k;
    }
    return numbers;
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

// Several sums at once: one sum waits for every addition.
template <class T>
T sum_of_products(View<const T, 1> a, View<const T, 1> b) {
    constexpr long WIDE = 64 / sizeof(T);
    T sums[WIDE] = {}, total = 0;
    long k = 0;
    for (; k + WIDE <= a.size(); k += WIDE)
        for (long m = 0; m < WIDE; ++m) sums[m] += a(k + m) * b(k + m);
    for (; k < a.size(); ++k) total += a(k) * b(k);
    for (T sum : sums) total += sum;
    return total;
}
inline double dot(Numbers a, Numbers b) { return sum_of_products(a, b); }
inline float dot(View<const float, 1> a, View<const float, 1> b) { return sum_of_products(a, b); }

}  // namespace wr
