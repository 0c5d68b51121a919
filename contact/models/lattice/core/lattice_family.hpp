// Contacts on the lattices of one pair of bodies: levels and cells along strips, with and without friction, from what a
// file has of them.
#pragma once
#include "contact/models/lattice/core/lattice_pair.hpp"

namespace wr {

constexpr int LEVELS = FINEST + 1 + int(NARROWER);  // and narrower ones in search of a pressure without tension
constexpr int REFINEMENTS_ALONG = 2;                // of the cells along strips, in the same search
constexpr int STARTS_FROM_NONE = 4;
constexpr std::size_t MOST_SETTINGS = 64;  // kept: hosts may set any coefficient of friction

// Strips of a level on the upper body.
struct LevelData {
    LatticeStrips strips;
    Numbers slenderness;  // (K,)

    auto fields() { return std::tie(strips, slenderness); }
    bool fits() const { return strips.size() > 2 && slenderness.size() == strips.size(); }
};

// Bases of strips with or without friction: that of the model, those with twice and four times as many cells, as far as
// these are not too many (counted by `LatticeData::finer`), and equal cells at starts.
struct FamilyBases {
    StripBasis own;
    std::array<StripBasis, REFINEMENTS_ALONG> finer;
    std::array<StripBasis, STARTS_FROM_NONE> starts;

    auto fields() { return std::tie(own, finer, starts); }
};

// Deviation of a finite body from a half-space.
struct BodyData {
    DeviationWeights weights;  // without lines: of a half-space
    Numbers spectra;           // between all tiles, the first and those after it, then the second, ..

    auto fields() { return std::tie(weights, spectra); }
    bool fits() const { return spectra.size() == start(tiles(), tiles()); }

    long tiles() const { return (weights.arc.size() + TILE - 1) / TILE; }
    std::array<long, 4> shape(long i, long j) const {
        long n = weights.arc.size();
        return {std::min(TILE, n - TILE * i), std::min(TILE, n - TILE * j), SPECTRA, weights.even.shape[1]};
    }
    // Where the spectra between two tiles start.
    long start(long first, long second) const {
        long at = 0;
        for (long i = 0; i < tiles(); ++i)
            for (long j = i; j < tiles(); ++j) {
                if (i == first && j == second) return at;
                auto [R, C, parts, K] = shape(i, j);
                at += R * C * parts * K;
            }
        return at;
    }
};

struct LatticeData {
    SurfaceData surface;
    Lines lines;
    Rows outline;  // (2, n) m, of the rail's surface, ascending
    std::array<LevelData, LEVELS> levels;
    HalfSpaces spaces;
    CellRule rule;
    bool moves = false;  // whether strips move on the lower body
    std::array<BodyData, 2> bodies;
    StripBasis first, second;
    std::array<FamilyBases, 2> bases;  // with friction, and without
    long finer = 0;
    long strips = 0;  // over a usual patch
    std::array<double, LEVELS> margin{};
    std::array<long, LEVELS> apart{};
    double tolerance = 0.0, regularisation = 0.0;
    Numbers law;  // constants of the law of friction; none without friction

    auto fields() {
        return std::tie(surface, lines, outline, levels, spaces, rule, moves, bodies, first, second, bases, finer,
                        strips, margin, apart, tolerance, regularisation, law);
    }
    bool fits() const {
        return finer >= 0 && finer <= REFINEMENTS_ALONG && strips > 0 && outline.shape[0] == 2 &&
               (!surface.revolves || (lines.of(surface.rail) && outline.shape[1] > 0));
    }
};

class LatticeFamily : public std::enable_shared_from_this<LatticeFamily> {
  public:
    // memory: what owns the numbers of the data. code: of the law of friction; none if there is none.
    LatticeFamily(const LatticeData& data, std::shared_ptr<const void> memory, std::shared_ptr<const FrictionCode> code)
        : data(data), memory(std::move(memory)), bodies{body(0), body(1)}, code(std::move(code)) {}

    // The contact with the law of friction of the data, or with constants of another one of the same class; without
    // friction if there are none.
    std::shared_ptr<const LatticeContact> contact(Numbers constants) {
        Array<double, 1> own_constants = Array<double, 1>::copy(constants);
        bool rolls = code && constants.size() > 0;
        ResidualCode law{rolls ? code.get() : nullptr, own_constants, rolls ? data.regularisation : 0.0};
        auto owned_law = std::make_shared<const Law>(law, Owners{own_constants.owner, code});
        auto own = shared_from_this();
        return std::make_shared<LatticeContact>(model(owned_law, 0, 0, true), [own, owned_law](int level) {
            return own->model(owned_law, level, 0, true);
        });
    }
    std::shared_ptr<const PairContact> pair() {
        auto own = shared_from_this();
        auto with_friction = [own](double mu) { return own->contact({&mu, {mu > 0.0 ? 1 : 0}}); };
        return std::make_shared<LatticePair>(contact(data.law), with_friction, code && data.law.size() > 0);
    }

  private:
    using Law = Owned<ResidualCode>;

    // Upper or lower body; none of a half-space.
    std::shared_ptr<FiniteBody> body(int which) const {
        const auto& of = data.bodies[which];
        if (of.tiles() == 0) return nullptr;
        return std::make_shared<FiniteBody>(of.weights, which == 1 && data.moves, [of, kept = memory](long i, long j) {
            long at = of.start(i, j);
            return Array<double, 4>::copy({of.spectra.part(at, of.spectra.size()).data, of.shape(i, j)});
        });
    }
    // The model of a level, with the cells along strips refined some times.
    std::shared_ptr<const LevelModel> model(const std::shared_ptr<const Law>& law, int level, int refined,
                                            bool searches) {
        auto own = shared_from_this();
        auto made = std::make_shared<LevelModel>();
        made->setting = setting(*law, level, refined), made->strips = data.strips, made->level = level;
        if (searches)
            made->finer = [own, law, level] {
                LevelModel::Models models;
                for (int n = 1; n <= own->data.finer; ++n) models.push_back(own->model(law, level, n, false));
                for (int n = 1; n <= int(NARROWER); ++n) models.push_back(own->model(law, level + n, 0, false));
                return models;
            };
        return made;
    }
    std::shared_ptr<const LatticeSetting> setting(const Law& law, int level, int refined) {
        std::lock_guard lock(making);
        if (settings.size() > MOST_SETTINGS) settings.clear();  // models at hand keep theirs
        auto& known = settings[{{law.parameters.begin(), law.parameters.end()}, level, refined}];
        if (known) return known;
        const auto& bases = data.bases[law.code ? 0 : 1];
        auto kept = [&](const auto& part) { return Owned<std::decay_t<decltype(part)>>(part, {memory}); };
        std::vector<Owned<StripBasis>> starts;
        starts.reserve(bases.starts.size());
        for (const auto& basis : bases.starts) starts.push_back(kept(basis));
        return known = std::make_shared<LatticeSetting>(LatticeSetting{
                   kept(data.surface), kept(data.lines), Array<double, 2>::copy(data.outline), tables(level),
                   kept(refined ? bases.finer[refined - 1] : bases.own), kept(data.first), kept(data.second), starts,
                   law, data.margin[level], data.apart[level], data.tolerance});
    }
    const std::shared_ptr<LatticeTables>& tables(int level) {
        auto& known = of_levels[level];
        const auto& [strips, slenderness] = data.levels[level];
        if (!known)
            known = std::make_shared<LatticeTables>(strips, slenderness, data.spaces, data.rule, bodies, data.moves);
        return known;
    }

    const LatticeData data;
    std::shared_ptr<const void> memory;
    std::array<std::shared_ptr<FiniteBody>, 2> bodies;
    std::shared_ptr<const FrictionCode> code;
    std::mutex making;
    std::array<std::shared_ptr<LatticeTables>, LEVELS> of_levels;
    std::map<std::tuple<std::vector<double>, int, int>, std::shared_ptr<const LatticeSetting>> settings;
};

}  // namespace wr
