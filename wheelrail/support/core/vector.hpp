// Vectors of three numbers, and matrices as three columns, of doubles or of numbers with derivatives.
#pragma once
#include <cmath>

#include "support/core/dual.hpp"

namespace wr {

template <class T>
struct Vec {
    T x{}, y{}, z{};
};

template <class T>
struct Matrix {
    Vec<T> x, y, z;  // columns
};

template <class A, class B>
auto operator+(const Vec<A>& a, const Vec<B>& b) {
    return Vec<decltype(a.x + b.x)>{a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class A, class B>
auto operator-(const Vec<A>& a, const Vec<B>& b) {
    return Vec<decltype(a.x - b.x)>{a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class A, class B>
auto operator*(const A& s, const Vec<B>& a) {
    return Vec<decltype(s * a.x)>{s * a.x, s * a.y, s * a.z};
}
// Products of the components.
template <class A, class B>
auto times(const Vec<A>& a, const Vec<B>& b) {
    return Vec<decltype(a.x * b.x)>{a.x * b.x, a.y * b.y, a.z * b.z};
}
template <class A, class B>
auto dot(const Vec<A>& a, const Vec<B>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class A, class B>
auto cross(const Vec<A>& a, const Vec<B>& b) {
    return Vec<decltype(a.x * b.y)>{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class A, class B>
auto operator*(const Matrix<A>& m, const Vec<B>& a) {
    return a.x * m.x + a.y * m.y + a.z * m.z;
}
// Product of a transposed matrix and a vector.
template <class A, class B>
auto back(const Matrix<A>& m, const Vec<B>& a) {
    return Vec<decltype(m.x.x * a.x)>{dot(m.x, a), dot(m.y, a), dot(m.z, a)};
}
template <class A, class B>
auto operator*(const Matrix<A>& m, const Matrix<B>& n) {
    return Matrix<decltype(m.x.x * n.x.x)>{m * n.x, m * n.y, m * n.z};
}
// Axes n in the axes m: product of the transposed matrix m and n.
template <class A, class B>
auto relative(const Matrix<A>& m, const Matrix<B>& n) {
    return Matrix<decltype(m.x.x * n.x.x)>{back(m, n.x), back(m, n.y), back(m, n.z)};
}

// Rz(yaw) Rx(roll) Ry(pitch) of angles rad.
template <class T>
Matrix<T> body_rotation(const T& roll, const T& pitch, const T& yaw) {
    using std::sin, std::cos;
    T cr = cos(roll), sr = sin(roll), cp = cos(pitch), sp = sin(pitch), cy = cos(yaw), sy = sin(yaw);
    return {{cy * cp - sy * sr * sp, sy * cp + cy * sr * sp, -cr * sp},
            {-sy * cr, cy * cr, sr},
            {cy * sp + sy * sr * cp, sy * sp - cy * sr * cp, cr * cp}};
}

// Rotation vector rad of a rotation by less than pi.
template <class T>
Vec<T> rotation_vector(const Matrix<T>& m) {
    using std::sqrt, std::atan;
    Vec<T> axial{0.5 * (m.y.z - m.z.y), 0.5 * (m.z.x - m.x.z), 0.5 * (m.x.y - m.y.x)};
    T squared = dot(axial, axial), cosine = 0.5 * (m.x.x + m.y.y + m.z.z - 1.0);
    if (value(squared) < 1e-16) return axial;
    T sine = sqrt(squared);
    return (2.0 * atan(sine / (1.0 + cosine)) / sine) * axial;
}

// Rotation by a rotation vector rad, Rodrigues' formula.
template <class T>
Matrix<T> rotation_matrix(const Vec<T>& v) {
    using std::sqrt, std::sin;
    T squared = dot(v, v), first = 1.0 - squared / 6.0, second = 0.5 - squared / 24.0;
    if (value(squared) >= 1e-8) {
        T angle = sqrt(squared), half = sin(0.5 * angle) / angle;
        first = sin(angle) / angle, second = 2.0 * (half * half);
    }
    const auto& [x, y, z] = v;
    return {{1.0 - second * (y * y + z * z), second * x * y + first * z, second * x * z - first * y},
            {second * x * y - first * z, 1.0 - second * (x * x + z * z), second * y * z + first * x},
            {second * x * z + first * y, second * y * z - first * x, 1.0 - second * (x * x + y * y)}};
}

// Moment conjugate to the gradient of a potential by the rotation vector, rad, of the upper in the axes of the lower
// body: transposed inverse of the left Jacobian of rotations, m = g + r x g / 2 + c r x (r x g), c = 1/12 for small r.
template <class T>
Vec<T> moment_of_gradient(const Vec<T>& rotation, const Vec<T>& gradient) {
    using std::sqrt, std::sin, std::cos;
    T squared = dot(rotation, rotation), factor = 1.0 / 12.0 + squared / 720.0;
    if (value(squared) >= 1e-6) {
        T angle = sqrt(squared);
        factor = 1.0 / squared - (1.0 + cos(angle)) / (2.0 * angle * sin(angle));
    }
    auto first = cross(rotation, gradient);
    return gradient + (0.5 * first + factor * cross(rotation, first));
}

}  // namespace wr
