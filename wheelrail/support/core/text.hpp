// Texts with numbers.
#pragma once
#include <charconv>
#include <cmath>
#include <cstdio>
#include <string>

namespace wr {

// Text in the format of printf.
template <class... A>
std::string text(const char* format, A... values) {
    int size = std::snprintf(nullptr, 0, format, values...);
    std::string result(size > 0 ? size : 0, '\0');
    std::snprintf(result.data(), result.size() + 1, format, values...);
    return result;
}

// Shortest text that reads back as the same number, as printed by Python.
inline std::string shortest(double x) {
    if (std::isnan(x)) return "nan";
    if (std::isinf(x)) return x < 0 ? "-inf" : "inf";
    bool plain = x == 0.0 || (std::abs(x) >= 1e-4 && std::abs(x) < 1e16);
    char digits[400];
    auto end = std::to_chars(digits, digits + sizeof digits, x,
                             plain ? std::chars_format::fixed : std::chars_format::scientific);
    std::string result(digits, end.ptr);
    return plain && result.find('.') == std::string::npos ? result + ".0" : result;
}

}  // namespace wr
