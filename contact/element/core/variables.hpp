// Numbers that a host program exchanges with the contact element of a wheelset: one table for arrays, C, Fortran, FMI
// and Python. Their order is that in arrays; a name is a valid identifier in all languages.
#pragma once
#include <string>
#include <vector>

namespace wr {

// A number with its unit, SI, "1" for numbers without, and a sentence without full stop.
struct Variable {
    std::string name, unit, description;
};
using Variables = std::vector<Variable>;

constexpr int INTERFACE = 100;  // version of the C header: changes that break programs add 100
constexpr int INPUTS = 17, FORCES = 12, OUTPUTS = 14, PATCH_VALUES = 13;
constexpr const char* SIDES[] = {"left", "right"};

// State of the wheelset, of the track frame and of the rails.
inline Variables input_variables() {
    Variables all{{"y", "m", "lateral position of the wheelset's centre, to the left"},
                  {"z", "m", "height of the wheelset's centre above the nominal one"},
                  {"roll", "rad", "rotation about the x axis after yaw"},
                  {"yaw", "rad", "rotation about z"},
                  {"y_rate", "m/s", "time derivative of y"},
                  {"z_rate", "m/s", "time derivative of z"},
                  {"roll_rate", "rad/s", "time derivative of roll"},
                  {"yaw_rate", "rad/s", "time derivative of yaw"},
                  {"pitch_rate", "rad/s", "spin about the axle, positive when rolling forward"},
                  {"speed", "m/s", "of the track frame along the track"}};
    for (std::string axis : {"x", "y", "z"})
        all.push_back({"frame_rate_" + axis, "rad/s", "of the track frame about its axis " + axis});
    for (std::string side : SIDES)
        for (std::string axis : {"y", "z"})
            all.push_back({side + "_rail_" + axis, "m",
                           "displacement of the " + side + " rail along " + axis + " by irregularities"});
    return all;
}

// Force and moment of the left, then of the right wheel, and approaches.
inline Variables output_variables() {
    Variables all;
    for (std::string side : SIDES)
        for (bool moment : {false, true})
            for (std::string axis : {"x", "y", "z"}) {
                std::string what = moment ? "moment of the contact force" : "contact force";
                what += " along " + axis + " on the " + side + " wheel, in the axes of the track";
                if (moment) what += ", about the wheelset's centre";
                all.push_back({side + (moment ? "_M" : "_F") + axis, moment ? "N.m" : "N", what});
            }
    for (std::string side : SIDES)
        all.push_back(
            {side + "_approach", "m", "largest penetration of the undeformed " + side + " pair, negative is a gap"});
    return all;
}

// Of the patch with the largest normal force of a side.
inline Variables patch_variables() {
    return {{"count", "1", "number of patches of the side"},
            {"area", "m2", "area of the patch"},
            {"max_pressure", "Pa", "largest pressure"},
            {"normal_force", "N", "normal force"},
            {"tangential_x", "N", "longitudinal force in the plane of contact"},
            {"tangential_y", "N", "lateral force in the plane of contact"},
            {"semi_axis_x", "m", "semi-axis along x of the ellipse with the same second moments of pressure"},
            {"semi_axis_y", "m", "semi-axis across x"},
            {"contact_angle", "rad", "rotation of the plane of contact about x"},
            {"wheel_y", "m", "lateral position on the wheel's profile, positive to the field side"},
            {"rail_y", "m", "lateral position on the rail's profile, positive to the field side"},
            {"stick_area", "m2", "area of adhesion"},
            {"frictional_power", "W", "frictional power of steady rolling"}};
}

// Parameters of an element, set when the element is opened.
inline Variables parameter_variables() {
    Variables all;
    for (std::string side : SIDES)
        all.push_back({side + "_friction", "1", "coefficient of friction of the " + side + " pair"});
    return all;
}

// Number of a variable, -1 for an unknown name.
inline int number_of(const Variables& all, const char* name) {
    for (std::size_t k = 0; name && k < all.size(); ++k)
        if (all[k].name == name) return int(k);
    return -1;
}

}  // namespace wr
