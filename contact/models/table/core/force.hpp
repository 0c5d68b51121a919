// Force of one wheel on one rail from a table, and its derivative.
//
// The interpolants have closed derivatives by their variables. The algebra between them is written once, for numbers
// and for dual numbers.
#pragma once
#include "contact/kinematics/core/left_pair.hpp"
#include "contact/models/table/core/lookup.hpp"

namespace wr {

constexpr double TABLE_ARM = 0.01;  // m, of the moments of friction
// creepage that about saturates a wheel with friction 0.3, at a load, N
constexpr double SATURATING = 2e-3, SATURATED = 1e5;

// Contact without and with friction of one wheel on one rail.
struct TableData {
    Grid normal, friction;     // of a `NormalTable`, and of a `FrictionTable`
    double coefficient = 0.0;  // of friction; 0: its table is not read
    double radius = 0.0;       // of the wheel, m
    double lateral = 0.0;      // nominal position of the tread from the rail's origin, m
    Numbers border;            // (4,) widths of its border in y m, roll and yaw rad, and level; or (0,), none

    auto fields() { return std::tie(normal, friction, coefficient, radius, lateral, border); }
    bool fits() const {
        for (double width : border)
            if (!(width > 0.0)) return false;
        return (border.size() == 0 || border.size() == LEVEL + 1) && normal.fits() && friction.fits() &&
               normal.axes() == LEVEL + 1 && normal.columns == CONTACT_NUMBERS && normal.counts[LEVEL] > 1 &&
               friction.axes() == FRICTION_AXES && friction.columns == FRICTION_NUMBERS;
    }
};

// Values (n,) that vary with m arguments: numbers (1 + m, n), the values, then their derivatives by these.
template <int n, class T>
std::array<T, n> moved(Rows values, const T* at, int arguments) {
    std::array<T, n> out;
    for (int c = 0; c < n; ++c) {
        out[c] = T(values(0, c));
        if constexpr (!std::is_same_v<T, double>)
            for (int k = 0; k < arguments; ++k)
                for (std::size_t d = 0; d < std::size(out[c].d); ++d) out[c].d[d] += values(1 + k, c) * at[k].d[d];
    }
    return out;
}

// Creepage that saturates a wheel, about: proportional to friction and to the cube root of the load.
template <class T>
T scale_of_creepage(const T& level, double coefficient) {
    using std::sqrt;
    return SATURATING * coefficient / 0.3 * sqrt(level / std::pow(SATURATED, 2.0 / 3.0));
}

// Lateral and vertical component of the normal of a force.
template <class T>
struct TableNormal {
    T y, z;

    explicit TableNormal(const Vec<T>& force) {
        using std::sqrt;
        T length = sqrt(force.y * force.y + force.z * force.z);
        y = force.y / length, z = force.z / length;
    }
};

// Rolling speed m/s; level, longitudinal and lateral coordinate of a `FrictionTable`.
//
// Below the smallest level its values are those of the smallest, beyond the largest creepages those of the same
// direction of slip; at speed 0 creepages are not finite.
template <class T>
struct FrictionVariables {
    T speed, level, along, across;

    // From a level, point m and force N without friction.
    FrictionVariables(const TableData& data, const T& contact_level, const Vec<T>& point, const Vec<T>& resultant,
                      const RigidMotion<T>& motion) {
        using std::asinh;
        auto velocity = [&](const Twist<T>& of) { return of.velocity + cross(of.rotation, point - of.reference); };
        Vec<T> own = velocity(motion.wheel), other = velocity(motion.rail);
        TableNormal<T> normal(resultant);
        speed = -0.5 * (own.x + other.x);
        T unit = speed * scale_of_creepage(contact_level, data.coefficient);
        T u = (own.x - other.x) / unit, v = ((own.y - other.y) * normal.z - (own.z - other.z) * normal.y) / unit;
        Numbers nodes = data.friction.axis(LONGITUDINAL);
        double largest = std::sinh(nodes(nodes.size() - 1)), lowest = data.friction.axis(LEVEL)(0);
        if (std::max(std::abs(value(u)), std::abs(value(v))) > largest) {
            T edge = std::abs(value(u)) > std::abs(value(v)) ? u : v;
            T factor = largest / (value(edge) > 0.0 ? edge : -edge);
            u = u * factor, v = v * factor;
        }
        level = value(contact_level) < lowest ? T(lowest) : contact_level;
        along = asinh(u), across = asinh(v);
    }
};

// Weight of a table: 3 u^2 - 2 u^3 of the distance u from its end inwards, over the width of the border, from 0 to 1.
template <class T>
T border_weight(const T& inwards, double width) {
    T u = inwards / width;
    if (!(value(u) > 0.0)) return T(0.0);
    return value(u) < 1.0 ? u * u * (3.0 - 2.0 * u) : T(1.0);
}

// Force from a table.
template <class T>
struct TableForce {
    Vec<T> force{}, moment{};         // N, N m about the rail's origin; zero at negative levels and speeds
    T share{1.0};                     // of the table beside an elastic contact: 1 inside of its border, 0 outside
    std::array<T, 4> position;        // y m, roll and yaw rad, z m of the tread
    double level = 0.0, depth = 0.0;  // (vertical load without friction / N)^(2/3), and m below first contact
    double speed = 1.0;               // m/s, of rolling; 1 without friction or contact
    Vec<T> point{}, resultant{};      // m and N, without friction

    TableForce(const TableData& data, const Pose<T>& pose, const RigidMotion<T>& motion) {
        using std::sqrt;
        constexpr bool slopes = !std::is_same_v<T, double>;
        const auto& [forth, axle, up] = pose.rotation;
        Vec<T> tread = pose.origin - data.radius * up;
        position = {tread.y - data.lateral, axle.z, -axle.x / axle.y, tread.z};
        double at[FRICTION_AXES];
        for (int k = 0; k < 4; ++k) at[k] = value(position[k]);
        TableContact contact(data.normal, at, slopes);
        level = contact.values(0, 0), depth = contact.depth;
        bool bordered = data.border.size() > 0;
        for (int k = 0; bordered && k < LEVEL; ++k) {
            Numbers nodes = data.normal.axis(k);
            double low = nodes(0), high = nodes(nodes.size() - 1);
            T inwards = at[k] + at[k] < low + high ? position[k] - low : high - position[k];
            share = share * border_weight(inwards, data.border(k));
        }
        if (!(level > 0.0)) return;
        auto of = moved<CONTACT_NUMBERS, T>(contact.values, position.data(), 4);
        Numbers levels = data.normal.axis(LEVEL);
        if (bordered) share = share * border_weight(levels(levels.size() - 1) - of[0], data.border(LEVEL));
        T load = of[0] * sqrt(of[0]);
        point = {tread.x + of[1], tread.y + of[2], tread.z + of[3]};
        resultant = {load * of[5], load * of[4], load};
        Vec<T> couple{load * of[6], load * of[7], load * of[8]}, total = resultant;
        if (data.coefficient > 0.0) {
            FrictionVariables<T> own(data, of[0], point, resultant, motion);
            speed = value(own.speed);
            if (!(speed > 0.0)) return;
            const T all[FRICTION_AXES] = {position[0], position[1], position[2], own.level, own.along, own.across};
            for (int k = 3; k < FRICTION_AXES; ++k) at[k] = value(all[k]);
            auto change = moved<FRICTION_NUMBERS, T>(values_at(data.friction, at, slopes), all, FRICTION_AXES);
            T bound = data.coefficient * load, arm = TABLE_ARM * bound;
            TableNormal<T> n(resultant);
            total =
                total + bound * Vec<T>{change[0], n.z * change[1] + n.y * change[2], n.z * change[2] - n.y * change[1]};
            couple = couple + arm * Vec<T>{change[3], change[4], change[5]};
        }
        force = total, moment = couple + cross(point, total);
    }
};

// Force and moment about the wheelset's centre of one wheel in the axes of the track.
template <class T>
struct TableWheel {
    TableForce<T> of;
    std::array<T, 6> wrench;  // N, N m

    TableWheel(const TableData& data, const Numbers& state, const Dimensions& dimensions, bool mirror)
        : TableWheel(data, left_pair(left_state<T>(state, mirror), dimensions), mirror) {}

  private:
    TableWheel(const TableData& data, const LeftPair<T>& pair, bool mirror) : of(data, pair.pose, pair.motion) {
        const auto& force = of.force;
        Vec<T> moment = of.moment - cross(pair.centre, force);
        wrench = {force.x, force.y, force.z, moment.x, moment.y, moment.z};
        for (int row : {1, 3, 5})
            if (mirror) wrench[row] = -wrench[row];
    }
};

// Numbers (20,) of a `wheelrail.contact.models.table.force_table.TableForce`.
inline void store_force(const TableForce<double>& of, const View<double, 1>& out) {
    auto store = [&](const Vec<double>& a, long at) { out(at) = a.x, out(at + 1) = a.y, out(at + 2) = a.z; };
    store(of.force, 0), store(of.moment, 3);
    std::copy(of.position.begin(), of.position.end(), &out(6));
    out(10) = of.level, out(11) = of.depth, out(12) = of.speed;
    store(of.point, 13), store(of.resultant, 16);
    out(19) = of.share;
}

// The same of a pose and motion.
inline Array<double, 1> table_force(const TableData& data, const Pose<double>& pose,
                                    const RigidMotion<double>& motion) {
    Array<double, 1> out(20);
    store_force({data, pose, motion}, out);
    return out;
}

// Numbers (w, 26) of w wheels of one side: force and moment about the wheelset's centre in the axes of the track, then
// those of `table_force` of the left-hand pair; parameters of `left_pairs`.
inline Array<double, 2> table_wheels(const TableData& data, const Rows& states, const Dimensions& dimensions,
                                     bool mirror) {
    Array<double, 2> out(states.size(), 26);
    for (long i = 0; i < states.size(); ++i) {
        TableWheel<double> wheel(data, states[i], dimensions, mirror);
        std::copy(wheel.wrench.begin(), wheel.wrench.end(), &out(i, 0));
        store_force(wheel.of, out[i].part(6, 26));
    }
    return out;
}

// Derivatives (w, 6, 9) of these forces and moments by the wheelsets' coordinates.
inline Array<double, 3> table_slopes(const TableData& data, const Rows& states, const Dimensions& dimensions,
                                     bool mirror) {
    Array<double, 3> out(states.size(), 6, COORDINATES);
    for (long i = 0; i < states.size(); ++i) {
        auto wrench = TableWheel<Dual<COORDINATES>>(data, states[i], dimensions, mirror).wrench;
        for (int row = 0; row < 6; ++row) std::copy(wrench[row].d, wrench[row].d + COORDINATES, &out(i, row, 0));
    }
    return out;
}

// Derivative (7, 12) of force and moment, see `wheelrail.contact.results.result.ContactResult.tangent`, zero where
// there is no contact or speed, and of the share.
inline Array<double, 2> table_derivative(const TableData& data, const Pose<double>& pose,
                                         const RigidMotion<double>& motion) {
    using T = Dual<12>;
    TableForce<T> of(data, varied<T>(pose), varied<T>(motion, pose));
    Array<double, 2> columns(7, 12);
    const T* rows[] = {&of.force.x, &of.force.y, &of.force.z, &of.moment.x, &of.moment.y, &of.moment.z, &of.share};
    for (int row = 0; row < 7; ++row) std::copy(rows[row]->d, rows[row]->d + 12, &columns(row, 0));
    return columns;
}

}  // namespace wr
