// SPDX-License-Identifier: Apache-2.0
// The pixels that step 3 of docs/algorithm.md compares.
#if defined(DISPARITYD_CPU_COST_CENSUS_WINDOW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_COST_CENSUS_WINDOW_INL_H_
#undef DISPARITYD_CPU_COST_CENSUS_WINDOW_INL_H_
#else
#define DISPARITYD_CPU_COST_CENSUS_WINDOW_INL_H_
#endif

#include <algorithm>

#include "kernels/cpu/simd/image_rows-inl.h"
#include "kernels/image.h"
#include "kernels/steps.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

constexpr int census_radius_x = 4;
constexpr int census_radius_y = 3;

/// The two costs of docs/algorithm.md that begin with a census, see CensusCost.
struct Census9x7 {
    static constexpr int coarseness = 0;  ///< see noise_level.h
    static constexpr int radius_y = census_radius_y;
    static constexpr int bits = 62;
    static constexpr std::uint8_t outside = 62;  ///< cost of a candidate outside
    static constexpr bool gradient = false;
    static constexpr bool averaged = false;  ///< over three rows

    /// Whether the pixel that lies so far from the centre has a bit.
    static constexpr bool compares(int dx, int dy) { return dx != 0 || dy != 0; }
};
struct Census7x5Gradient {
    static constexpr int coarseness = 0;
    static constexpr int radius_y = 2;
    static constexpr int bits = 30;
    static constexpr std::uint8_t outside = 18;
    static constexpr bool gradient = true;
    static constexpr bool averaged = true;

    static constexpr bool compares(int dx, int dy) {
        const int across = dx < 0 ? -dx : dx;
        const int along = dy < 0 ? -dy : dy;
        return across <= 3 && along <= 2 && across + along != 0 && across + along != 5;
    }
};

enum class Order : std::uint8_t {
    natural,
    mirrored,  ///< the last column of the image comes first
};

/// The second one at noise levels.
template <int census_coarseness>
struct NoisyCensus7x5Gradient : Census7x5Gradient {
    static constexpr int coarseness = census_coarseness;
};

/// The rows up to `radius` from the row in work, with their borders replicated, as signed bytes (the order stays, and
/// signed comparison is an instruction everywhere).
template <Order order, int radius>
class CensusWindow {
public:
    CensusWindow(Plane<const std::uint8_t> image, int first) : image_(image) {
        for (int y = first - radius; y < first + radius; ++y) {
            load(y);
        }
    }

    /// To be called for y = first, first + 1, ..
    void move_to(int y) { load(y + radius); }

    const std::uint8_t* row(int y) const { return &rows_[(y + rows) % rows][row_slack]; }

private:
    static constexpr int rows = 2 * radius + 2;  // a ring

    void load(int y) {
        const hn::ScalableTag<std::uint8_t> tag;
        const int lanes = static_cast<int>(hn::Lanes(tag));
        const int width = image_.width;
        const std::uint8_t* in = image_.row(std::clamp(y, 0, image_.height - 1));
        std::uint8_t* out = &rows_[(y + rows) % rows][row_slack];
        if constexpr (order == Order::mirrored) {
            mirror(in, width, out);
        } else {
            std::copy_n(in, width, out);
        }
        std::fill_n(out - census_radius_x, census_radius_x, out[0]);
        const auto last = hn::Set(tag, out[width - 1]);
        for (int x = width; x < width + row_slack; x += lanes) {
            hn::StoreU(last, tag, out + x);
        }
        const auto sign = hn::Set(tag, 0x80);
        for (int x = -lanes; x < width + census_radius_x; x += lanes) {
            hn::StoreU(hn::Xor(hn::LoadU(tag, out + x), sign), tag, out + x);
        }
    }

    Plane<const std::uint8_t> image_;
    alignas(64) std::uint8_t rows_[rows][max_side + 2 * row_slack] = {};
};

/// What the words of a row of pixels are made from.
struct CensusRows {
    const std::int8_t* neighbours[2 * census_radius_y + 1];
    const std::int8_t* centres[3];  ///< the row in work between the ones above and below it
};

/// The windows of an image: one, or two where the centre is smoothed.
template <class Cost, Order order, bool smoothed = (Cost::coarseness > 0)>
class CensusSource {
public:
    CensusSource(Plane<const std::uint8_t> image, Plane<const std::uint8_t> /*smoothed*/, int first)
        : window_(image, first) {}

    void move_to(int y) { window_.move_to(y); }

    /// From position x on.
    CensusRows rows(int y, int x) const {
        CensusRows rows{};
        for (int dy = -Cost::radius_y; dy <= Cost::radius_y; ++dy) {
            rows.neighbours[Cost::radius_y + dy] = reinterpret_cast<const std::int8_t*>(window_.row(y + dy) + x);
        }
        std::copy_n(rows.neighbours + Cost::radius_y - 1, 3, rows.centres);
        return rows;
    }

private:
    CensusWindow<order, census_radius_y> window_;
};

template <class Cost, Order order>
class CensusSource<Cost, order, true> {
public:
    CensusSource(Plane<const std::uint8_t> image, Plane<const std::uint8_t> smoothed, int first)
        : window_(image, first), smoothed_(smoothed, first) {}

    void move_to(int y) {
        window_.move_to(y);
        smoothed_.move_to(y);
    }

    CensusRows rows(int y, int x) const {
        CensusRows rows{};
        for (int dy = -Cost::radius_y; dy <= Cost::radius_y; ++dy) {
            const std::uint8_t* row = window_.row(y + Cost::coarseness * dy);
            rows.neighbours[Cost::radius_y + dy] = reinterpret_cast<const std::int8_t*>(row + x);
        }
        for (int dy = -1; dy <= 1; ++dy) {
            rows.centres[1 + dy] = reinterpret_cast<const std::int8_t*>(smoothed_.row(y + dy) + x);
        }
        return rows;
    }

private:
    CensusWindow<order, Cost::radius_y * Cost::coarseness> window_;
    CensusWindow<order, 1> smoothed_;
};

/// What is at from - census_radius_x .. from + census_radius_x. Where no more is loaded for it, some of it without
/// loads, which would all but one cross cache lines.
template <class Tag, class V = hn::Vec<Tag>>
HWY_INLINE void load_beside(Tag tag, const std::int8_t* from, V* beside) {
    static_assert(census_radius_x == 4);
    constexpr bool between = bytes_to_next == census_radius_x;
    V* middle = beside + census_radius_x;
    DISPARITYD_UNROLL
    for (int dx = -census_radius_x; dx <= census_radius_x; ++dx) {
        if (!between || dx <= 0 || dx == census_radius_x) {
            middle[dx] = in_register(hn::LoadU(tag, from + dx));
        }
    }
    if constexpr (between) {
        middle[1] = bytes_between<1>(middle[0], middle[4]);
        middle[2] = bytes_between<2>(middle[0], middle[4]);
        middle[3] = bytes_between<3>(middle[0], middle[4]);
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
