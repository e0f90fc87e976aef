// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "kernels/image.h"
#include "kernels/options.h"

namespace disparityd::bench {

/// L of a pixel from L of the one before on its path (step 5 of docs/algorithm.md): `path` and `before` hold one cost
/// per candidate and do not overlap, `min_before` is the least of `before`. Returns the least of `path`.
using ContinuePath = std::uint8_t (*)(const std::uint8_t* cost, int disparities, int p1, int p2,
                                      const std::uint8_t* before, std::uint8_t min_before, std::uint8_t* path);

/// Plain scalar code with one idea of the paper left out, or alone: what the reference gives, by another way. Pure
/// functions; planes and volumes of one call have one size.
struct PlainVariants {
    /// Step 2 without its second pass: the window is summed anew for every candidate.
    void (*sad_in_one_pass)(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right, DisparityRange range,
                            Volume<std::uint16_t> costs, Rows rows);
    /// Steps 3 and 4 without the first pass: the words of step 3 are the pixels themselves ..
    void (*pixels_as_words)(Plane<const std::uint8_t> image, Plane<std::uint64_t> words, Rows rows);
    /// .. of which both census words are made anew for every candidate.
    void (*matching_cost_in_one_pass)(Plane<const std::uint64_t> left, Plane<const std::uint64_t> right,
                                      DisparityRange range, Volume<std::uint8_t> costs, Rows rows);
    /// Step 5 with 8 paths and without adaptive P2, in two sweeps over the image with four paths each.
    void (*aggregate_in_two_sweeps)(Volume<const std::uint8_t> costs, int p1, int p2, Volume<std::uint16_t> sums,
                                    std::span<std::uint8_t> scratch, ContinuePath continue_path);
    std::size_t (*two_sweeps_scratch)(int width, int disparities);  ///< bytes that aggregate_in_two_sweeps() needs

    ContinuePath min_once;           ///< the least cost of the pixel before is found once per pixel
    ContinuePath min_per_candidate;  ///< it is looked for again for every candidate
};

}  // namespace disparityd::bench
