// Open elements of a process behind numbers, with errors as text: what functions in C call.
#pragma once
#include <cctype>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>

#include "contact/loading/core/element_under_load.hpp"
#include "export/core/options.hpp"
#include "export/core/wheelset_file.hpp"

namespace wr {

constexpr int DONE = 0, FAILURE = 1, NOBODY = 0;  // as in the C header; NOBODY: in place of an element's number

// Path of a folder that is a path or a URL file://...
inline std::string path_of(std::string folder) {
    if (!folder.starts_with("file:")) return folder;
    folder.erase(0, 5);
    if (folder.starts_with("//")) folder.erase(0, std::min(folder.find('/', 2), folder.size()));
    std::string path;
    for (std::size_t k = 0; k < folder.size(); ++k) {
        std::string code = folder.substr(k, 3);
        bool is_code = code.size() == 3 && code[0] == '%' && std::isxdigit(code[1]) && std::isxdigit(code[2]);
        path += is_code ? char(std::stoi(code.substr(1), nullptr, 16)) : folder[k];
        if (is_code) k += 2;
    }
    return path;
}

struct OpenElement {
    std::shared_ptr<const WheelsetFile> file;
    WheelsetElement element;
    std::map<int, Accepted> states;  // stored ones
    std::string error;               // text of the last failure
    std::mutex lock;

    OpenElement(std::shared_ptr<const WheelsetFile> own, WheelsetContact contact)
        : file(std::move(own)), element(std::move(contact)) {}
};

// All open elements of a process, by number from 1; those of one file share it. Functions return DONE or FAILURE,
// `open` a number or NOBODY; none throws. Elements are independent: threads solve different ones at the same time.
class OpenedElements {
  public:
    // Number of a new element of the options and the folder of a C host; library: folder of the library.
    int open(const char* options, const char* folder, const std::string& library) {
        return guarded(error_, NOBODY, [&] {
            auto given = OptionsReader(options ? options : "").read();
            std::string name = DEFAULT_FILE, place = folder && *folder ? path_of(folder) : library;
            std::map<std::string, double> numbers;
            for (auto& [key, value] : given) {
                bool is_text = std::holds_alternative<std::string>(value);
                if (key == "scene" && is_text)
                    name = std::get<std::string>(value);
                else if ((key == "friction" || key == "left_friction" || key == "right_friction") && !is_text)
                    numbers[key] = std::get<double>(value);
                else
                    throw std::invalid_argument("options: " + key +
                                                ": must be one of scene, a file that was exported, "
                                                "friction, left_friction and right_friction");
            }
            auto file = opened(name.starts_with('/') || place.empty() ? name : place + "/" + name);
            auto contact = file->contact;
            for (int side = 0; side < 2; ++side)
                for (std::string own : {"", side ? "right" : "left"})
                    if (auto mu = numbers.find(own.empty() ? "friction" : own + "_friction"); mu != numbers.end())
                        set_friction(*file, contact, side, own.empty() ? "friction" : own + ".friction", mu->second);
            auto element = std::make_shared<OpenElement>(file, std::move(contact));
            std::lock_guard guard(lock_);
            elements_[++count_] = std::move(element);
            return count_;
        });
    }
    int close(int number) {
        std::lock_guard guard(lock_);
        if (elements_.erase(number)) return DONE;
        error_ = not_open(number);
        return FAILURE;
    }
    // Do something with an element; failures are its error.
    template <class F>
    int with(int number, const F& action) {
        auto own = element(number);
        if (!own) {
            std::lock_guard guard(lock_);
            error_ = not_open(number);
            return FAILURE;
        }
        std::lock_guard guard(own->lock);
        return guarded(own->error, FAILURE, [&] {
            action(*own);
            return DONE;
        });
    }
    // Do something with the head of the file in a folder.
    template <class F>
    int describe(const char* folder, const F& action) {
        return guarded(error_, FAILURE, [&] {
            std::string place = path_of(folder);
            action(opened(place.empty() ? DEFAULT_FILE : place + "/" + DEFAULT_FILE)->head);
            return DONE;
        });
    }
    // Text of the last failure of an element, or of `open` for NOBODY.
    std::string error(int number) {
        auto own = element(number);
        std::lock_guard guard(own ? own->lock : lock_);
        return own ? own->error : error_;
    }
    std::shared_ptr<const WheelsetFile> opened(const std::string& path) {
        std::lock_guard guard(lock_);
        std::error_code none;
        auto written = std::filesystem::last_write_time(path, none);
        auto& [known, own] = files_[path];
        auto file = own.lock();
        if (!file || known != written) own = file = std::make_shared<const WheelsetFile>(path), known = written;
        return file;
    }

  private:
    // An open element, or null.
    std::shared_ptr<OpenElement> element(int number) {
        std::lock_guard guard(lock_);
        auto found = elements_.find(number);
        return found == elements_.end() ? nullptr : found->second;
    }
    template <class F>
    int guarded(std::string& error, int failed, const F& action) {
        std::string reason;
        try {
            return action();
        } catch (const std::exception& thrown) {
            reason = thrown.what();
        } catch (...) {
            reason = "unknown failure";
        }
        if (&error == &error_) {
            std::lock_guard guard(lock_);
            error = reason;
        } else {
            error = reason;
        }
        return failed;
    }
    static std::string not_open(int number) { return "element " + std::to_string(number) + ": not open"; }
    static void set_friction(const WheelsetFile& file, WheelsetContact& contact, int side, const std::string& name,
                             double mu) {
        if (std::isnan(file.head.friction[side]))
            throw std::invalid_argument("options: " + name + ": the scene has a law of friction, which remains");
        if (!file.head.coefficients.allow(mu))
            throw std::invalid_argument("Wheelset: " + name + text(" = %g", mu) + ": must be " +
                                        file.head.coefficients.allowed);
        if (mu != file.head.friction[side]) contact.models[side] = file.contact.models[side]->with_friction(mu);
    }

    std::mutex lock_;  // of what follows
    std::map<int, std::shared_ptr<OpenElement>> elements_;
    // by path, with the time of writing
    std::map<std::string, std::pair<std::filesystem::file_time_type, std::weak_ptr<const WheelsetFile>>> files_;
    int count_ = 0;
    std::string error_;
};

}  // namespace wr
