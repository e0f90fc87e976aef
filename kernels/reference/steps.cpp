// SPDX-License-Identifier: Apache-2.0
#include "kernels/reference/steps.h"

namespace disparityd::reference {

namespace {

// Steps over the whole image, in the thread of whoever calls.
void speckle_here(Plane<std::int16_t> disparity, const RegionTest& test, std::span<std::byte> scratch,
                  Parallel& /*workers*/) {
    speckle(disparity, test, scratch);
}

void interpolate_here(Plane<std::int16_t> disparity, Plane<const std::int16_t> right_winner, DisparityRange range,
                      std::span<std::byte> scratch, Parallel& /*workers*/) {
    interpolate(disparity, right_winner, range, scratch);
}

}  // namespace

const KernelSteps steps = {
    .frame =
        {
            .rectify = rectify,
            .rectify_colour = rectify_colour,
            .smooth = smooth,
            .left_right = left_right,
            .median = median,
            .vote = vote,
            .speckle = speckle_here,
            .speckle_scratch = speckle_scratch,
            .finish_confidence = finish_confidence,
            .interpolate = interpolate_here,
            .interpolate_scratch = interpolate_scratch,
            .guided_median = guided_median,
            .depth = depth,
            .depth_error = depth_error,
            .shrink = shrink,
            .scan_counts = scan_counts,
        },
    .matching =
        {
            .sad = sad,
            .census_costs = {{{census, matching_cost}, {census_gradient, census_gradient_cost}}},
            .noisy_census = noisy_census,
            .aggregate = aggregate,
            .aggregate_scratch = aggregate_scratch,
            .winner_u8 = {winner_left<std::uint8_t>, winner_right<std::uint8_t>, local_extrema<std::uint8_t>},
            .winner_u16 = {winner_left<std::uint16_t>, winner_right<std::uint16_t>, local_extrema<std::uint16_t>},
        },
};

}  // namespace disparityd::reference
