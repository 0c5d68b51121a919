// The file of an exported wheelset: contact models of both sides, and what a program asks for before it solves.
#pragma once
#include <cerrno>
#include <cstring>
#include <fstream>

#include "contact/element/core/wheelset_element.hpp"
#include "contact/laws/core/law_library.hpp"
#include "contact/models/lattice/core/lattice_family.hpp"
#include "contact/models/standard/core/standard_contact.hpp"
#include "export/core/sealed_file.hpp"

namespace wr {

constexpr const char* DEFAULT_FILE = "contact.wheelset";  // as the library looks for

// Allowed range of numbers from low to high, and its text.
struct AllowedRange {
    double low = 0.0, high = 0.0;
    std::string allowed;

    auto fields() { return std::tie(low, high, allowed); }
    bool allow(double x) const { return low <= x && x <= high; }
};

struct WheelsetHead {
    std::string token;  // of a functional mock-up unit, which has to be that of the file
    Numbers start;      // (17,) inputs of the state of the scene, in equilibrium with its load
    std::array<AllowedRange, INPUTS> inputs;
    std::array<double, 2> friction;  // coefficients of both sides; NaN of a law, which cannot be set
    AllowedRange coefficients;       // allowed ones
    AllowedRange loads;              // N, allowed ones of a wheel
    std::array<double, 2> sphere;    // radius m and contact modulus Pa, for first estimates of the approach
    std::array<Dimensions, 2> dimensions;
    long sides = 2;  // 1: one model serves both

    auto fields() { return std::tie(token, start, inputs, friction, coefficients, loads, sphere, dimensions, sides); }
    bool fits() const { return start.size() == INPUTS && (sides == 1 || sides == 2); }

    // First input that is not a number in its range, with the range; empty where there is none.
    std::string invalid(const Numbers& values) const {
        for (int k = 0; k < INPUTS; ++k)
            if (!inputs[k].allow(values(k)))
                return input_variables()[k].name + " = " + shortest(values(k)) + ": must be " + inputs[k].allowed;
        return "";
    }
};

// Kinds of contact models, numbers before their data.
enum Kind : long { STANDARD = 1, LATTICE = 2 };

// Contact on a lattice, and the sum of the library of its law of friction, which is beside the file.
struct LatticeFile {
    LatticeData data;
    long law = 0;

    auto fields() { return std::tie(data, law); }
};

inline std::string wheelset_look() {
    return layout<WheelsetHead>() + layout<StandardData>() + layout<LatticeFile>() + "1";
}

// Name of the library of a law of friction with a sum.
inline std::string law_name(long sum) { return text("law-%016lx.so", static_cast<unsigned long>(sum)); }

// Words of a file; the last one is filled up with zeros. Throws std::runtime_error.
inline Array<long, 1> words_of_file(const std::string& path) {
    errno = 0;
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    long bytes = file ? long(file.tellg()) : -1;
    if (bytes < 0) throw std::runtime_error(std::string("cannot be read: ") + std::strerror(errno ? errno : EIO));
    Array<long, 1> words((bytes + 7) / 8);
    file.seekg(0);
    if (bytes > 0 && !file.read(reinterpret_cast<char*>(words.data), bytes)) throw std::runtime_error("cannot be read");
    return words;
}

// Functions of a law of friction, from the library with a sum beside a file. Throws std::runtime_error.
inline std::shared_ptr<const FrictionCode> law_beside(const std::string& file, long sum) {
    std::string path = file.substr(0, file.rfind('/') + 1) + law_name(sum);
    try {
        if (sum_of(words_of_file(path)) != sum) throw std::runtime_error("is not the one that was exported");
        return std::make_shared<const FrictionCode>(friction_code(path));
    } catch (const std::exception& error) {
        throw std::runtime_error(path + ": " + error.what());
    }
}

// A file that is open. Throws std::runtime_error with the path for one that cannot be read, or is damaged.
struct WheelsetFile {
    Array<long, 1> words;  // to which head and models refer
    WheelsetHead head;
    WheelsetContact contact;

    explicit WheelsetFile(const std::string& path) {
        try {
            words = words_of_file(path);
            Reader reader(words, wheelset_look());
            head = reader.get<WheelsetHead>();
            for (int side = 0; side < 2; ++side) {
                contact.models[side] = side < head.sides ? model(reader, path) : contact.models[0];
                contact.dimensions[side] = head.dimensions[side];
            }
        } catch (const std::runtime_error& error) {
            throw std::runtime_error(path + ": " + error.what());
        }
    }

  private:
    std::shared_ptr<const PairContact> model(Reader& reader, const std::string& path) const {
        long kind = reader.get<long>();
        if (kind == STANDARD) return std::make_shared<StandardContact>(reader.get<StandardData>());
        if (kind != LATTICE) throw std::runtime_error("has a contact model that is not known");
        auto own = reader.get<LatticeFile>();
        auto code = law_beside(path, own.law);
        if (own.data.law.size() && code->parameters != own.data.law.size()) throw std::runtime_error("is damaged");
        return std::make_shared<LatticeFamily>(own.data, words.owner, code)->pair();
    }
};

}  // namespace wr
