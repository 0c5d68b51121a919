// Structures as words of a file: little-endian, sealed by a sum, checked when they are read.
//
// Structures name their fields in order, as for Python: auto fields() { return std::tie(first, second); }. A file has
// four words before the structures: a name, a sum of what the structures look like, which changes with every version
// of them, the number of the words that follow, and their sum.
#pragma once
#include <bit>
#include <complex>
#include <cstring>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include "support/core/owned.hpp"

namespace wr {

static_assert(std::endian::native == std::endian::little && sizeof(long) == 8);

constexpr long SEAL = 4;                        // words before the structures
constexpr long FILE_NAME = 0x6c69617272686c77;  // "wlhrrail"
constexpr unsigned long SUM_START = 14695981039346656037ul, SUM_FACTOR = 1099511628211ul;  // of Fowler, Noll and Vo

inline long sum_of(const Indices& words) {
    unsigned long sum = SUM_START;
    for (long word : words) sum = (sum ^ static_cast<unsigned long>(word)) * SUM_FACTOR;
    return static_cast<long>(sum ^ (sum >> 29U));
}

// Number of words of n elements.
template <class T>
constexpr long words_of(long n) {
    return (n * long(sizeof(T)) + 7) / 8;
}

// Kinds of field types: arrays of N dimensions, and arrays of a fixed number.
template <class T>
struct FieldOf {
    static constexpr int dimensions = 0;
};
template <class T, int N>
struct FieldOf<View<T, N>> {
    static constexpr int dimensions = N;
    using Element = std::remove_const_t<T>;
};
template <class T, int N>
struct FieldOf<Array<T, N>> : FieldOf<View<T, N>> {};

// Text that tells structures apart: letters of types, parentheses around the fields of a structure.
template <class T>
std::string layout() {
    if constexpr (std::is_same_v<T, double>) return "d";
    if constexpr (std::is_same_v<T, std::complex<double>>) return "c";
    if constexpr (std::is_same_v<T, float>) return "f";
    if constexpr (std::is_same_v<T, int>) return "i";
    if constexpr (std::is_same_v<T, long>) return "l";
    if constexpr (std::is_same_v<T, bool>) return "b";
    if constexpr (std::is_same_v<T, std::string>) return "s";
    if constexpr (FieldOf<T>::dimensions > 0)
        return std::to_string(FieldOf<T>::dimensions) + layout<typename FieldOf<T>::Element>();
    if constexpr (Structure<T>) {
        std::string all = "(";
        T example{};
        std::apply([&](auto&... field) { ((all += layout<std::decay_t<decltype(field)>>()), ...); }, example.fields());
        return all + ")";
    }
    if constexpr (requires { std::tuple_size<T>::value; } && !Structure<T>)
        return std::string("a").append(std::to_string(std::tuple_size_v<T>)).append(layout<typename T::value_type>());
    return "";
}

// Words of structures.
class Writer {
  public:
    template <class T>
    void put(const T& data) {
        if constexpr (std::is_arithmetic_v<T>) {
            long word = 0;
            std::memcpy(&word, &data, sizeof data);
            words_.push_back(word);
        } else if constexpr (std::is_same_v<T, std::string>) {
            put(long(data.size()));
            append(data.data(), long(data.size()));
        } else if constexpr (FieldOf<T>::dimensions > 0) {
            for (long n : data.shape) put(n);
            append(data.data, data.count());
        } else if constexpr (Structure<T>) {
            std::apply([&](const auto&... field) { (put(field), ...); }, const_cast<T&>(data).fields());
        } else {
            for (const auto& element : data) put(element);
        }
    }
    // The file, with structures that look like this.
    std::string sealed(const std::string& look) const {
        Indices body{words_.data(), {long(words_.size())}};
        long seal[SEAL] = {FILE_NAME, look_of(look), body.size(), sum_of(body)};
        std::string file(8 * (SEAL + words_.size()), '\0');
        std::memcpy(file.data(), seal, sizeof seal);
        if (!words_.empty()) std::memcpy(&file[sizeof seal], words_.data(), 8 * words_.size());
        return file;
    }
    static long look_of(const std::string& look) {
        std::vector<long> letters(look.begin(), look.end());
        return sum_of(Indices{letters.data(), {long(letters.size())}});
    }

  private:
    template <class T>
    void append(const T* from, long n) {
        std::size_t first = words_.size();
        words_.resize(first + words_of<T>(n));
        if (n > 0) std::memcpy(&words_[first], from, n * sizeof(T));
    }
    std::vector<long> words_;
};

// Structures of words. Views refer to the words, arrays are copies. Throws std::runtime_error.
class Reader {
  public:
    // The words of a file whose structures look like this.
    Reader(const Indices& file, const std::string& look) : words_(file) {
        if (file.size() < SEAL || file(0) != FILE_NAME) throw std::runtime_error("is no file of a contact");
        if (file(1) != Writer::look_of(look))
            throw std::runtime_error("is of another version of wheelrail than this library: export it anew");
        words_ = file.part(SEAL, file.size());
        if (file(2) != words_.size() || file(3) != sum_of(words_)) throw std::runtime_error("is damaged");
    }
    template <class T>
    T get() {
        T data{};
        if constexpr (std::is_arithmetic_v<T>) {
            long word = words_(next(1));
            std::memcpy(&data, &word, sizeof data);
        } else if constexpr (std::is_same_v<T, std::string>) {
            long n = size();
            auto from = view<char>(n);
            data.assign(from.begin(), from.end());
        } else if constexpr (FieldOf<T>::dimensions > 0) {
            using Element = typename FieldOf<T>::Element;
            View<const Element, FieldOf<T>::dimensions> own;
            long total = 1;
            for (long& n : own.shape) {
                n = size();
                if (total > 0 && n > 8 * words_.size() / total) throw std::runtime_error("is damaged");
                total *= n;
            }
            own.data = view<Element>(total).data;
            if constexpr (requires { T::copy(own); })
                data = T::copy(own);
            else
                data = own;
        } else if constexpr (Structure<T>) {
            std::apply([&](auto&... field) { ((field = get<std::decay_t<decltype(field)>>()), ...); }, data.fields());
            if constexpr (requires { data.fits(); })
                if (!data.fits()) throw std::runtime_error("is damaged");
        } else {
            for (auto& element : data) element = get<std::decay_t<decltype(element)>>();
        }
        return data;
    }

  private:
    long size() {
        long n = get<long>();
        if (n < 0 || n > 8 * words_.size()) throw std::runtime_error("is damaged");
        return n;
    }
    // Number of the first of some words that are read next.
    long next(long count) {
        if (count > words_.size() - at_) throw std::runtime_error("is damaged");
        return std::exchange(at_, at_ + count);
    }
    template <class T>
    View<const T, 1> view(long n) {
        long first = next(words_of<T>(n));
        return {n > 0 ? reinterpret_cast<const T*>(&words_(first)) : nullptr, {n}};
    }
    Indices words_;
    long at_ = 0;
};

}  // namespace wr
