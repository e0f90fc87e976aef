// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "kernels/depth_error.h"
#include "kernels/image.h"
#include "kernels/matcher.h"
#include "kernels/options.h"
#include "kernels/parallel.h"
#include "kernels/raw_image.h"
#include "kernels/scan_counts.h"

namespace disparityd {

/// The largest rectified image, per side. Kernels keep what they need of a row on the stack.
constexpr int max_side = 8192;
constexpr int max_disparities = 256;
/// Step 12: a sample counts whose intensity differs from the pixel's by at most so much.
constexpr int guided_median_tolerance = 20;

/// Winner-takes-all and what needs the costs besides it, for matching costs or summed costs of type T.
template <typename T>
struct WinnerSteps {
    /// Step 6: the winner of each pixel of the left image in whole pixels, and its disparity in 1/16 px, refined when
    /// `subpixel`.
    void (*left)(Volume<const T> costs, DisparityRange range, bool subpixel, Plane<std::int16_t> winner,
                 Plane<std::int16_t> disparity, Rows rows);
    /// Step 6: the winner of each pixel of the right image, from the same costs; range.first - 1 where no candidate
    /// lies inside the left image.
    void (*right)(Volume<const T> costs, DisparityRange range, Plane<std::int16_t> winner, Rows rows);
    /// Steps 7 and 13: rejects disparities of unclear winners, and writes the confidence of all (0 = rejected).
    void (*local_extrema)(Volume<const T> costs, DisparityRange range, const PostOptions& options,
                          Plane<const std::int16_t> winner, Plane<std::int16_t> disparity,
                          Plane<std::uint8_t> confidence, Rows rows);
};

/// What step 10 asks of each region.
struct RegionTest {
    std::int16_t invalid = 0;  ///< marks a rejected pixel
    int min_size = 0;          ///< regions of fewer pixels are rejected
    int max_step = 0;          ///< in 1/16 px: what differs by at most so much belongs together
    int min_texture = 0;       ///< in percent, as the option; 0: not asked, and the pair may be missing
    Plane<const std::uint8_t> left = {};
    Plane<const std::uint8_t> right = {};
};

// The steps of docs/algorithm.md as a back end computes them, all with the bytes of the reference's (tests/kernels
// compares them).
//
// All are pure functions: no threads of their own, no allocation, no state. A function with `rows` computes these rows
// of its output and may be called for disjoint rows at the same time; planes and volumes of one call have one size,
// rows of input are read beyond `rows` where a window needs them.

/// What comes before and after matching, whatever the method.
struct FrameSteps {
    /// Step 1: luma of one eye, rectified.
    void (*rectify)(const RawImage& raw, Eye eye, const Rectifier& rectifier, Plane<std::uint8_t> out, Rows rows);
    /// Step 1: one eye in colour, rectified; `bgr` is 3 * width wide.
    void (*rectify_colour)(const RawImage& raw, Eye eye, const Rectifier& rectifier, Plane<std::uint8_t> bgr,
                           Rows rows);

    /// Step 3, at noise levels above 0: the image smoothed.
    void (*smooth)(Plane<const std::uint8_t> image, Plane<std::uint8_t> smoothed, Rows rows);

    /// Step 8: rejects, in `disparity`, what the winners of both images do not agree on.
    void (*left_right)(Plane<const std::int16_t> left_winner, Plane<const std::int16_t> right_winner,
                       DisparityRange range, Plane<std::int16_t> disparity, Rows rows);
    /// Step 9: `size` is 3 or 5. `in` and `out` do not overlap.
    void (*median)(Plane<const std::int16_t> in, std::int16_t invalid, int size, Plane<std::int16_t> out, Rows rows);
    /// Step 9, at noise levels above 0. `in` and `out` do not overlap.
    void (*vote)(Plane<const std::int16_t> in, std::int16_t invalid, Plane<std::int16_t> out, Rows rows);
    /// Step 10, in place, the whole image, spread over `workers`.
    void (*speckle)(Plane<std::int16_t> disparity, const RegionTest& test, std::span<std::byte> scratch,
                    Parallel& workers);
    std::size_t (*speckle_scratch)(int width, int height);
    /// Step 13: no confidence where the disparity is rejected; elsewhere the chance that the ratio stands for, where
    /// `calibrated`.
    void (*finish_confidence)(Plane<const std::int16_t> disparity, std::int16_t invalid, bool calibrated,
                              Plane<std::uint8_t> confidence, Rows rows);
    /// Step 11, in place, the whole image, spread over `workers`.
    void (*interpolate)(Plane<std::int16_t> disparity, Plane<const std::int16_t> right_winner, DisparityRange range,
                        std::span<std::byte> scratch, Parallel& workers);
    std::size_t (*interpolate_scratch)(int width, int height);
    /// Step 12: `size` is 5 or 7, `guide` the rectified left image. `in` and `out` do not overlap.
    void (*guided_median)(Plane<const std::int16_t> in, Plane<const std::uint8_t> guide, std::int16_t invalid, int size,
                          Plane<std::int16_t> out, Rows rows);
    /// Step 13.
    void (*depth)(Plane<const std::int16_t> disparity, std::int16_t invalid, DepthScale scale,
                  Plane<std::uint16_t> depth, Rows rows);
    /// Step 13, of a finished image: 0 where the confidence is 0.
    void (*depth_error)(Plane<const std::int16_t> disparity, Plane<const std::uint8_t> confidence,
                        const DepthErrorScale& scale, Plane<std::uint16_t> error, Rows rows);
    /// Step 16: an image of a quarter of the size, near_blocks() of the columns and rows of `image`; `rows` are of
    /// `out`.
    void (*shrink)(Plane<const std::uint8_t> image, Plane<std::uint8_t> out, Rows rows);
    /// Step 14, of a finished image.
    scan::CountPixels* scan_counts;
};

/// A cost of CENSUS and SGM.
struct CensusSteps {
    /// Step 3.
    void (*census)(Plane<const std::uint8_t> image, Plane<std::uint64_t> words, Rows rows);
    /// Step 4.
    void (*matching_cost)(Plane<const std::uint64_t> left, Plane<const std::uint64_t> right, DisparityRange range,
                          Volume<std::uint8_t> costs, Rows rows);
};

/// Matching, one step after the other.
struct MatchingSteps {
    /// Step 2.
    void (*sad)(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right, DisparityRange range,
                Volume<std::uint16_t> costs, Rows rows);
    /// Of each CensusCost.
    std::array<CensusSteps, 2> census_costs;
    /// Step 3, census-7x5+gradient at a noise level of this coarseness, 1 or 2 (census_coarseness()).
    void (*noisy_census)(Plane<const std::uint8_t> image, Plane<const std::uint8_t> smoothed, int coarseness,
                         Plane<std::uint64_t> words, Rows rows);

    /// Step 5, the whole volume: spread over `workers` as the back end sees fit.
    void (*aggregate)(Volume<const std::uint8_t> costs, Plane<const std::uint8_t> left, const SgmOptions& options,
                      Volume<std::uint16_t> sums, std::span<std::byte> scratch, Parallel& workers);
    std::size_t (*aggregate_scratch)(int width, int height, int disparities);  ///< bytes that aggregate() needs

    /// Steps 6, 7 and 13 on the matching costs of census, and on costs of SAD and sums of SGM.
    WinnerSteps<std::uint8_t> winner_u8;
    WinnerSteps<std::uint16_t> winner_u16;

    const CensusSteps& of(CensusCost cost) const { return census_costs[static_cast<std::size_t>(cost)]; }
};

/// All of them.
struct KernelSteps {
    FrameSteps frame;
    MatchingSteps matching;
};

/// Returns the steps of the fastest back end of the processor.
const FrameSteps& fastest_frame_steps();

}  // namespace disparityd
