// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "kernels/cpu/census_layout.h"
#include "kernels/image.h"
#include "kernels/options.h"
#include "kernels/steps.h"

namespace disparityd::cpu {

/// How the candidates of a pixel lie in vector registers: candidate k = registers * lane + r is in lane `lane` of
/// register r, so that the neighbours k - 1 and k + 1 of a whole register are two other registers, and only the first
/// and the last register need a shift by one lane. `lanes * registers` is the number of candidates rounded up; what is
/// too much costs `padding_cost`, which never wins and never influences its neighbours.
struct DisparityLayout {
    int lanes = 0;
    int registers = 0;

    int candidates() const { return lanes * registers; }
    std::size_t bytes() const { return static_cast<std::size_t>(candidates()); }
};

/// Least cost that is out of reach of all others: 62 (largest cost) + 63 (largest P2), and a little. Kernels for a
/// larger P2 see to padding themselves.
constexpr std::uint8_t padding_cost = 128;

/// The largest P2 of sgm_kernels(): sums of four paths fit a byte (4 * 63 = 252).
constexpr int max_byte_p2 = 63;

/// What stays the same for all rows of a frame.
struct SgmGeometry {
    int width = 0;
    int height = 0;
    DisparityRange range;
    DisparityLayout layout;
    CensusLayout census;
    int raised_cost = 0;  ///< what matching costs in memory are too large by

    std::size_t row_bytes() const { return static_cast<std::size_t>(width) * layout.bytes(); }
};

/// Path costs L of the row before and the least of each pixel, of the three paths that come from it (from the pixel
/// before, above and after), indexed by position along the sweep (the column, or counted from the right end in the
/// upward sweep), with guard pixels on both sides.
struct PathRow {
    std::uint8_t* costs[3] = {};
    std::uint8_t* least[3] = {};
};

constexpr int path_guard = 64;  ///< guard pixels on either side of a PathRow

/// Least costs are taken for this many pixels at a time, one block late.
constexpr int least_block = 16;

/// Rows that are worked on together run this many pixels apart, whole blocks: a row needs the least costs of its upper
/// right neighbour.
constexpr int row_lag = 2 * least_block;

/// Steps [first, end) of aggregate(), whole blocks: step t works on position t of the first row and on position
/// t - row_lag of the second.
struct SweepSteps {
    int first = 0;
    int end = 0;
};

/// All steps of `rows` rows.
constexpr int steps_of(int width, int rows) {
    return (width + row_lag * (rows - 1) + least_block - 1) / least_block * least_block;
}

/// How many positions of a PathRow are done after `steps` steps: costs and least costs of the last of `rows` rows.
constexpr int done_after(int steps, int width, int rows) {
    return steps == steps_of(width, rows) ? width : steps - least_block - row_lag * (rows - 1);
}

/// Two paths and the least of one, of two rows.
constexpr int max_sweep_state = 2 * (2 * max_disparities + 64);

/// One row of a sweep, all arrays with the candidates of one pixel after the other.
struct SweepRow {
    const std::uint8_t* costs = nullptr;   ///< matching costs of the row
    std::uint8_t* sums = nullptr;          ///< out: sum of L - C over the paths of the sweep
    const std::uint8_t* jumps[4] = {};     ///< P2 by position, of PathRow's paths and of the one along the row
    const std::uint8_t* prefetch[2] = {};  ///< rows of sums and of costs that are needed soon; used when not null
};

enum class Store : std::uint8_t {
    keep,    ///< plain stores
    stream,  ///< past the caches: follow with hwy::FlushStream before another thread reads
};

struct SweepPass {
    int direction = 1;  ///< 1: downwards and to the right, -1: upwards and to the left
    int p1 = 0;
    int p2 = 0;
    Store store = Store::keep;
};

/// Rows of results.
struct WinnerRow {
    std::int16_t* winner = nullptr;
    std::int16_t* disparity = nullptr;
    std::uint8_t* confidence = nullptr;
    std::int16_t* right_winner = nullptr;
};

/// Where results go; all planes have the size of the image.
struct WinnerPlanes {
    Plane<std::int16_t> disparity;
    Plane<std::uint8_t> confidence;
    Plane<std::int16_t> winner;
    Plane<std::int16_t> right_winner;

    WinnerRow row(int y) const { return {winner.row(y), disparity.row(y), confidence.row(y), right_winner.row(y)}; }
};

/// The SGM kernels of one instruction set, for one number of candidates. All are pure functions on rows.
struct SgmKernels {
    DisparityLayout layout;
    int sum_bytes = 1;     ///< of a candidate in SweepRow::sums; words have an order of their own
    int raised_cost = 0;   ///< SgmGeometry::raised_cost of these kernels
    int rows_at_once = 1;  ///< how many rows aggregate() likes to be given; it takes 1 to this many
    bool streams = false;  ///< there are stores past the caches

    /// Strides and sizes of census planes.
    CensusLayout (*census_layout)(int width, DisparityLayout layout);
    /// Census of rows [first, last) into planes of these rows (`planes` points to row 0).
    void (*census_left)(const SgmGeometry& geometry, Plane<const std::uint8_t> image, std::uint8_t* planes, Rows rows);
    /// The same for the right image, mirrored: candidates of a pixel in ascending order, split by register.
    void (*census_right)(const SgmGeometry& geometry, Plane<const std::uint8_t> image, std::uint8_t* planes, Rows rows);
    /// Matching costs of one row from the row's planes; those of `next` are asked for, as they are needed soon. Where
    /// it is not null, `streamed` gets the costs too, past the caches as with Store::stream: here, where nothing else
    /// goes to memory, and not in aggregate(), or memory would have too little to do in one of them and too much in the
    /// other.
    void (*matching_cost)(const SgmGeometry& geometry, const CensusRow& census, const CensusRow& next,
                          std::uint8_t* costs, std::uint8_t* streamed);
    /// The paths of a sweep over `count` rows, the first of them first in the direction of the sweep: some of their
    /// steps, in order. To reach position p, `before` must be done up to p + 1. `state`, max_sweep_state bytes aligned
    /// to 64, is carried from one call to the next.
    void (*aggregate)(const SgmGeometry& geometry, const SweepPass& pass, const PathRow& before, const SweepRow* rows,
                      int count, SweepSteps steps, std::uint8_t* state);
    /// Adaptive P2 of one row of the left image: SweepRow::jumps (to be rounded up to whole vectors).
    void (*jumps)(const SgmGeometry& geometry, const SweepPass& pass, const std::uint8_t* row,
                  const std::uint8_t* row_before, std::uint8_t* const* jumps);
    /// Winners of one row: S = down + up + C once for each path.
    void (*winner)(const SgmGeometry& geometry, const PostOptions& options, const std::uint8_t* down,
                   const std::uint8_t* up, const std::uint8_t* costs, const WinnerRow& out);
};

/// What rows of a frame of this size are for these kernels, matching costs as their paths want them.
inline SgmGeometry geometry_for(const SgmKernels& kernels, int width, int height, DisparityRange range) {
    const CensusLayout census = kernels.census_layout(width, kernels.layout);
    return {width, height, range, kernels.layout, census, kernels.raised_cost};
}

/// The kernels for an instruction set of Highway (one bit of hwy::SupportedTargets()): 8 paths, P2 up to max_byte_p2.
/// path_kernels.h has those for other options.
SgmKernels sgm_kernels(std::int64_t target, int disparities);

}  // namespace disparityd::cpu
