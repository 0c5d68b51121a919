// Options of an element that a program opens: a JSON object of texts and numbers.
#pragma once
#include <charconv>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>

namespace wr {

using Option = std::variant<std::string, double>;

// Throws std::invalid_argument for anything but one object of texts and numbers.
class OptionsReader {
  public:
    explicit OptionsReader(std::string_view text) : rest_(text) {}

    std::map<std::string, Option> read() {
        std::map<std::string, Option> options;
        skip();
        if (rest_.empty()) return options;
        require('{');
        if (!found('}')) {
            do {
                std::string name = quoted();
                require(':');
                skip();
                if (rest_.starts_with('"'))
                    options[name] = quoted();
                else if (rest_.starts_with("null"))
                    rest_.remove_prefix(4);
                else
                    options[name] = number(name);
            } while (found(','));
            require('}');
        }
        skip();
        if (!rest_.empty()) fail();
        return options;
    }

  private:
    [[noreturn]] void fail() const {
        throw std::invalid_argument("options: must be a JSON object of texts and numbers, wrong at: " +
                                    std::string(rest_.substr(0, 40)));
    }
    void skip() { rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t\r\n"), rest_.size())); }
    bool found(char c) {
        skip();
        if (!rest_.starts_with(c)) return false;
        rest_.remove_prefix(1);
        return true;
    }
    void require(char c) {
        if (!found(c)) fail();
    }
    double number(const std::string& name) {
        double value = 0.0;
        auto end = std::from_chars(rest_.begin(), rest_.end(), value);
        if (end.ec != std::errc()) throw std::invalid_argument("options: " + name + ": must be a text or a number");
        rest_.remove_prefix(end.ptr - rest_.data());
        return value;
    }
    std::string quoted() {
        require('"');
        std::string result;
        while (!rest_.starts_with('"')) {
            if (rest_.empty()) fail();
            char c = rest_.front();
            rest_.remove_prefix(1);
            if (c == '\\') {  // names of files need no others
                if (rest_.empty() || std::string_view("\"\\/").find(rest_.front()) == std::string_view::npos) fail();
                c = rest_.front();
                rest_.remove_prefix(1);
            }
            result += c;
        }
        rest_.remove_prefix(1);
        return result;
    }
    std::string_view rest_;
};

}  // namespace wr
