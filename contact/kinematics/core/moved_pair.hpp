// Pairs of a wheel whose hub has moved against its wheelset and a rail that has moved, and the loads on both.
#pragma once
#include "contact/kinematics/core/left_pair.hpp"

namespace wr {

constexpr int MOVES = 9;                    // motions of the hub (6) and of the rail (3), loads on them
constexpr int MOVED = COORDINATES + MOVES;  // coordinates of a moved pair: the wheelset's, then those motions

// One side of w wheelsets: values (w, 17) of `WheelsetState`; motions (w, 9) of hub (x, y, z m, rotation vector rad, in
// the wheelset's axes) and rail (y, z m, roll rad about its foot) as left-hand ones; dimensions; foot y, z m; whether
// the side is the right one, which then is the mirror image of the pair.
struct MovedStates {
    Array<double, 2> values, moves;
    Dimensions dimensions{};
    std::array<double, 2> foot{};
    bool mirror = false;

    auto fields() { return std::tie(values, moves, dimensions, foot, mirror); }
    bool fits() const { return values.shape[1] == STATE && moves.shape == std::array<long, 2>{size(), MOVES}; }
    long size() const { return values.size(); }
};

// A left-hand pair in the frame of its moved rail, with the wheelset's centre in that frame.
template <class T>
struct MovedPair {
    LeftPair<T> pair;
    Matrix<T> rail, wheelset;  // axes in the track's
    Vec<T> arm,
        above_foot;  // m, from the wheelset's centre to the hub's, from the rail's foot to the wheelset's centre
};

// The pair of wheelset i. Dual numbers vary by its coordinates. The hub stands still in space while the wheel spins;
// rates of both motions are neglected.
template <class T>
MovedPair<T> moved_pair(const MovedStates& states, long i) {
    using std::sin, std::cos;
    auto left = left_state<double>(states.values.part(i, i + 1)[0], states.mirror);
    std::array<T, OWN> own;
    for (int k = 0; k < OWN; ++k) own[k] = k < COORDINATES ? variable<T>(left[k], k) : T(left[k]);
    std::array<T, MOVES> moves;
    for (int k = 0; k < MOVES; ++k) moves[k] = variable<T>(states.moves(i, k), COORDINATES + k);
    auto rigid = left_pair(own, states.dimensions);
    MovedPair<T> moved;
    const auto& axes = moved.wheelset = rigid.pose.rotation;
    moved.arm = axes * Vec<T>{moves[0], moves[1] + states.dimensions[0], moves[2]};
    auto wheel = axes * rotation_matrix(Vec<T>{moves[3], moves[4], moves[5]});
    T c = cos(moves[8]), s = sin(moves[8]), none(0.0), one(1.0);
    const auto& rail = moved.rail = {{one, none, none}, {none, c, s}, {none, -s, c}};
    Vec<T> pivot{none, T(states.foot[0]), T(states.foot[1])}, foot = pivot + Vec<T>{none, moves[6], moves[7]};
    auto seen = [&](const Vec<T>& point) { return back(rail, point - foot) + pivot; };
    moved.above_foot = rigid.centre - foot;
    const auto& [velocity, rotation, reference] = rigid.motion.rail;
    auto slow = rigid.motion.wheel.rotation - own[8] * axes.y;
    auto& pair = moved.pair;
    pair.pose = {seen(rigid.centre + moved.arm), relative(rail, wheel), rigid.pose.plan};
    pair.motion.wheel = {back(rail, rigid.motion.wheel.velocity + cross(slow, moved.arm)),
                         back(rail, slow + own[8] * wheel.y), pair.pose.origin};
    pair.motion.rail = {back(rail, velocity), back(rail, rotation), seen(reference)};
    pair.centre = seen(rigid.centre);
    return moved;
}

// Loads (9,) on the structure by a wrench on the wheel about the wheelset's centre, in the track's axes: force and
// moment on the hub, in the wheelset's axes about the hub's centre; y and z force and roll moment on the rail about its
// foot.
template <class T>
std::array<T, MOVES> loads_of(const MovedPair<T>& moved, const Vec<T>& force, const Vec<T>& moment) {
    auto push = back(moved.wheelset, force), turn = back(moved.wheelset, moment - cross(moved.arm, force));
    return {push.x,   push.y,   push.z,
            turn.x,   turn.y,   turn.z,
            -force.y, -force.z, -(moment.x + cross(moved.above_foot, force).x)};
}

// Pairs of w wheels and the axes (w, 3, 3) of their rails in the track's.
inline std::pair<WheelPairs, Array<double, 3>> moved_pairs(const MovedStates& states) {
    WheelPairs pairs(states.size());
    Array<double, 3> rails(states.size(), 3, 3);
    for (long i = 0; i < states.size(); ++i) {
        auto moved = moved_pair<double>(states, i);
        pairs.store(i, moved.pair);
        const Vec<double>* columns[] = {&moved.rail.x, &moved.rail.y, &moved.rail.z};
        for (int k = 0; k < 3; ++k)
            rails(i, 0, k) = columns[k]->x, rails(i, 1, k) = columns[k]->y, rails(i, 2, k) = columns[k]->z;
    }
    return {std::move(pairs), std::move(rails)};
}

// Matrices (w, 9, 6) of the loads by wrenches on left-hand wheels.
inline Array<double, 3> moved_loads(const MovedStates& states) {
    Array<double, 3> matrices(states.size(), MOVES, 6);
    for (long i = 0; i < states.size(); ++i) {
        auto moved = moved_pair<double>(states, i);
        for (int column = 0; column < 6; ++column) {
            double unit[6] = {};
            unit[column] = 1.0;
            auto loads = loads_of(moved, {unit[0], unit[1], unit[2]}, {unit[3], unit[4], unit[5]});
            for (int k = 0; k < MOVES; ++k) matrices(i, k, column) = loads[k];
        }
    }
    return matrices;
}

// Derivatives (w, 9, 18) of the loads at constant wrenches (w, 6) on left-hand wheels.
inline Array<double, 3> moved_load_slopes(const MovedStates& states, const Rows& wrenches) {
    using T = Dual<MOVED>;
    Array<double, 3> changes(states.size(), MOVES, MOVED);
    for (long i = 0; i < states.size(); ++i) {
        auto w = wrenches[i];
        auto loads =
            loads_of(moved_pair<T>(states, i), Vec<T>{T(w(0)), T(w(1)), T(w(2))}, Vec<T>{T(w(3)), T(w(4)), T(w(5))});
        for (int k = 0; k < MOVES; ++k) std::copy(loads[k].d, loads[k].d + MOVED, changes[i][k].begin());
    }
    return changes;
}

// Derivatives (w, 6, 18) of wrenches about the wheelsets' centres in the track's axes.
//
// Parameters:
//     tangents: (w, 6, 12) of wrenches about constant centres, in the axes of the moved rails.
//     wrenches: (w, 6) in the track's axes.
inline Array<double, 3> moved_slopes(const MovedStates& states, const Blocks& tangents, const Rows& wrenches) {
    using T = Dual<MOVED>;
    Array<double, 3> slopes(states.size(), 6, MOVED);
    for (long i = 0; i < states.size(); ++i) {
        auto moved = moved_pair<T>(states, i);
        const auto& [origin, rotation, plan] = moved.pair.pose;
        auto turned = small_rotation(value(rotation), rotation);
        const auto& velocity = moved.pair.motion.wheel;
        const Vec<T>* parts[] = {&origin, &turned, &velocity.velocity, &velocity.rotation};
        auto axes = value(moved.rail);
        auto given = wrenches[i];
        auto force = back(axes, Vec<double>{given(0), given(1), given(2)});
        auto moment = back(axes, Vec<double>{given(3), given(4), given(5)});
        T wrench[6] = {T(force.x), T(force.y), T(force.z), T(moment.x), T(moment.y), T(moment.z)};
        auto tangent = tangents[i];
        for (int r = 0; r < 6; ++r)
            for (int k = 0; k < MOVED; ++k)
                for (int p = 0; p < 4; ++p)
                    wrench[r].d[k] += tangent(r, 3 * p) * parts[p]->x.d[k] + tangent(r, 3 * p + 1) * parts[p]->y.d[k] +
                                      tangent(r, 3 * p + 2) * parts[p]->z.d[k];
        Vec<T> push{wrench[0], wrench[1], wrench[2]}, about{wrench[3], wrench[4], wrench[5]};
        about = about - cross(moved.pair.centre - vec_as<T>(value(moved.pair.centre)), push);  // which moves
        Vec<T> turned_push = moved.rail * push, turned_about = moved.rail * about;
        const T* rows[] = {&turned_push.x,  &turned_push.y,  &turned_push.z,
                           &turned_about.x, &turned_about.y, &turned_about.z};
        for (int r = 0; r < 6; ++r) std::copy(rows[r]->d, rows[r]->d + MOVED, slopes[i][r].begin());
    }
    return slopes;
}

}  // namespace wr
