// Normal problem: exact pressures at the contact points for given tangential tractions.
//
// 0 <= p, g = N p - d >= 0, p g = 0.
#pragma once
#include <deque>
#include <vector>

#include "support/core/lu.hpp"
#include "support/core/owned.hpp"

namespace wr {

constexpr double ROUND_OFF = 1e-12;
constexpr int EXCHANGED = 5;            // steps without progress before single points are exchanged
constexpr std::size_t STORED_SETS = 4;  // of active points whose factors are kept

using Mask = std::vector<bool>;

// Product (n,) of a matrix (n, m) and a vector (m,).
inline Array<double, 1> product(Rows matrix, Numbers vector) {
    Array<double, 1> result(matrix.size());
    for (long i = 0; i < matrix.size(); ++i) result(i) = dot(matrix[i], vector);
    return result;
}

// Chosen rows and columns (k, k) of a matrix.
inline Array<double, 2> chosen_of(Rows matrix, const std::vector<long>& rows) {
    long k = long(rows.size());
    Array<double, 2> some(k, k);
    for (long r = 0; r < k; ++r)
        for (long c = 0; c < k; ++c) some(r, c) = matrix(rows[r], rows[c]);
    return some;
}

// Response of the pressure to the penetration by exact contact: N (n, n) m/Pa, and LU factors of its rows and columns
// of the latest sets of active points.
class NormalResponse {
  public:
    explicit NormalResponse(const Array<double, 2>& compliance) : compliance(compliance) {}

    // Replace right-hand sides (k, a) of the a active points by the pressures.
    void solve(const Mask& active, View<double, 2> right) {
        const auto& of = factors(active);
        wr::solve<double>(of.lu, of.pivots, right);
    }

    struct Solution {
        Array<double, 1> pressure;  // (n,) Pa
        Mask active;                // (n,)
    };
    // Pressures of penetrations (n,) m, by a primal-dual active set from an initial guess of the active points.
    //
    // Each step is a Newton step of the semi-smooth complementarity. If the number of violating points does not
    // decrease, single points are exchanged until it does, which terminates as N is positive definite: block principal
    // pivoting, Judice and Pires, doi:10.1016/0305-0548(94)90106-6. Throws NotConverged.
    Solution pressures(Numbers penetration, Mask active) {
        long n = penetration.size(), fewest = n + 1;
        double largest = 0.0;
        for (double d : penetration) largest = std::max(largest, std::abs(d));
        int patience = EXCHANGED;
        for (long step = 0; step < 100 * (n + 1); ++step) {
            Array<double, 1> pressure(n);
            auto index = numbers_of(active);
            long a = long(index.size()), violations = 0, last = 0;
            Array<double, 2> loaded(1, a);
            double highest = 0.0;
            if (a) {
                for (long k = 0; k < a; ++k) loaded(0, k) = penetration(index[k]);
                solve(active, loaded);
                for (long k = 0; k < a; ++k)
                    pressure(index[k]) = loaded(0, k), highest = std::max(highest, loaded(0, k));
            }
            Mask violating(n, false);
            for (long i = 0; i < n; ++i) {
                violating[i] = active[i] ? pressure(i) < -ROUND_OFF * highest
                                         : dot(compliance[i], pressure) < penetration(i) - ROUND_OFF * largest;
                if (violating[i]) ++violations, last = i;
            }
            if (!violations) {
                for (double& p : pressure) p = std::max(p, 0.0);
                return {pressure, active};
            }
            if (violations < fewest)
                fewest = violations, patience = EXCHANGED;
            else
                --patience;
            for (long i = patience < 0 ? last : 0; i < n; ++i)
                if (violating[i]) active[i] = !active[i];
        }
        throw NotConverged("the active set of contact points did not converge");
    }

  private:
    struct Factors {
        Mask active;
        Array<double, 2> lu;
        Array<int, 1> pivots;
    };
    const Factors& factors(const Mask& active) {
        for (const auto& known : stored)
            if (known.active == active) return known;
        auto index = numbers_of(active);
        long a = long(index.size());
        // columns are scaled by the points' areas: positive definite up to that scaling, but not symmetric
        Factors made{active, Array<double, 2>(a, a), Array<int, 1>(a)};
        for (long i = 0; i < a; ++i)
            for (long k = 0; k < a; ++k) made.lu(i, k) = compliance(index[i], index[k]);
        factorise<double>(made.lu, made.pivots);
        if (stored.size() >= STORED_SETS) stored.pop_front();
        stored.push_back(made);
        return stored.back();
    }

    Array<double, 2> compliance;
    std::deque<Factors> stored;
};

}  // namespace wr
