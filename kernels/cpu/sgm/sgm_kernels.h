// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "kernels/cpu/census_layout.h"
#include "kernels/cpu/cost/matching_cost_kernel.h"
#include "kernels/cpu/match_layout.h"
#include "kernels/image.h"
#include "kernels/options.h"
#include "kernels/steps.h"

namespace disparityd::cpu {

/// The largest P2 of sgm_kernels(): sums of four paths fit a byte (4 * 63 = 252).
constexpr int max_byte_p2 = 63;

/// Path costs L of the previous row and the least of each pixel, of the three paths that come from it (from position p
/// - 1, p and p + 1), indexed by position along the sweep (the column, or counted from the right end in the upward
/// sweep), with guard pixels on both sides.
struct PathRow {
    std::uint8_t* costs[3] = {};
    std::uint8_t* least[3] = {};
};

constexpr int path_guard = 64;  ///< guard pixels on either side of a PathRow

/// Least costs are taken for this many pixels at a time, one block late.
constexpr int min_block = 16;

/// Rows that are worked on together run this many pixels apart, whole blocks: a row needs the least costs of its upper
/// right neighbour.
constexpr int row_lag = 2 * min_block;

/// Steps [first, end) of aggregate(), whole blocks: step t works on position t of the first row and on position
/// t - row_lag of the second.
struct SweepSteps {
    int first = 0;
    int end = 0;
};

/// All steps of `rows` rows.
constexpr int steps_of(int width, int rows) {
    return (width + row_lag * (rows - 1) + min_block - 1) / min_block * min_block;
}

/// How many positions of a PathRow are done after `steps` steps: costs and least costs of the last of `rows` rows.
constexpr int done_after(int steps, int width, int rows) {
    return steps == steps_of(width, rows) ? width : steps - min_block - row_lag * (rows - 1);
}

/// Two paths and the least of one, of two rows.
constexpr int max_sweep_state = 2 * (2 * max_disparities + 64);

/// One row of a sweep, all arrays with the candidates of one pixel after the other.
struct SweepRow {
    const std::uint8_t* costs = nullptr;   ///< matching costs of the row
    std::uint8_t* sums = nullptr;          ///< out: sum of L - C over the paths of the sweep
    const std::uint8_t* others = nullptr;  ///< what the other sweep left there; when not null, it is added to `sums`
    const std::uint8_t* p2_rows[4] = {};   ///< P2 by position, of PathRow's paths and of the one along the row
    const std::uint8_t* prefetch[2] = {};  ///< rows of sums and of costs that are needed soon; used when not null
};

/// Sums of L - C over paths, for winners.
struct SumRows {
    const std::uint8_t* sums = nullptr;        ///< of one sweep; where `adds_sums`, of both
    const std::uint8_t* others = nullptr;      ///< of the other sweep, unless `adds_sums`
    const std::uint8_t* next_costs = nullptr;  ///< where `adds_sums`: costs of a row that are needed soon
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

/// Census of rows [first, last) into planes of these rows (`planes` points to row 0); `smoothed` is looked at at noise
/// levels only.
using CensusKernel = void (*)(const MatchGeometry& geometry, Plane<const std::uint8_t> image,
                              Plane<const std::uint8_t> smoothed, std::uint8_t* planes, Rows rows);

struct CensusKernels {
    CensusKernel left = nullptr;
    CensusKernel right = nullptr;  ///< mirrored: candidates of a pixel in ascending order, split by register
};

/// The SGM kernels of one instruction set, for one number of candidates. All are pure functions on rows.
struct SgmKernels {
    DisparityLayout layout;
    int sum_bytes = 1;            ///< of a candidate in SweepRow::sums; words have an order of their own
    int cost_bias = 0;            ///< MatchGeometry::cost_bias of these kernels
    int rows_at_once = 1;         ///< how many rows aggregate() likes to be given; it takes 1 to this many
    bool streams = false;         ///< there are stores past the caches
    bool averages_costs = false;  ///< over rows: matching_cost() wants SingleRowCosts
    bool adds_sums = false;       ///< aggregate() takes SweepRow::others, and winner() wants them added

    /// Strides and sizes of census planes.
    CensusLayout (*census_layout)(int width, DisparityLayout layout);
    CensusKernels census;
    CensusKernels noisy_census[2];  ///< at noise levels of coarseness 1 and 2; null where the cost has none
    MatchingCostKernel matching_cost;
    /// The paths of a sweep over `count` rows, the first of them first in the direction of the sweep: some of their
    /// steps, in order. To reach position p, `previous_row` must be done up to p + 1. `state`, max_sweep_state bytes
    /// aligned to 64, is carried from one call to the next.
    void (*aggregate)(const MatchGeometry& geometry, const SweepPass& pass, const PathRow& previous_row,
                      const SweepRow* rows, int count, SweepSteps steps, std::uint8_t* state);
    /// Adaptive P2 of one row of the left image: SweepRow::p2_rows (to be rounded up to whole vectors).
    void (*adaptive_p2)(const MatchGeometry& geometry, int direction, const SgmOptions& options,
                        const std::uint8_t* row, const std::uint8_t* previous_row, std::uint8_t* const* p2_rows);
    /// Winners of one row: S = the sums of both sweeps + C once for each path.
    void (*winner)(const MatchGeometry& geometry, const PostOptions& options, const SumRows& sums,
                   const std::uint8_t* costs, const WinnerRow& out);
};

/// What rows of a frame of this size are for these kernels, matching costs as their paths want them.
inline MatchGeometry geometry_for(const SgmKernels& kernels, int width, int height, DisparityRange range) {
    const CensusLayout census = kernels.census_layout(width, kernels.layout);
    return {width, height, range, kernels.layout, census, kernels.cost_bias};
}

/// The kernels for an instruction set of Highway (one bit of hwy::SupportedTargets()): 8 paths, P2 up to max_byte_p2.
/// path_kernels.h has those for other options.
SgmKernels sgm_kernels(std::int64_t target, int disparities);

}  // namespace disparityd::cpu
