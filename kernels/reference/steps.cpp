// SPDX-License-Identifier: Apache-2.0
#include "kernels/reference/steps.h"

namespace disparityd::reference {

const KernelSteps steps = {
    .rectify = rectify,
    .rectify_colour = rectify_colour,
    .sad = sad,
    .census = census,
    .matching_cost = matching_cost,
    .aggregate = aggregate,
    .aggregate_scratch = aggregate_scratch,
    .winner_u8 = {winner_left<std::uint8_t>, winner_right<std::uint8_t>, local_extrema<std::uint8_t>},
    .winner_u16 = {winner_left<std::uint16_t>, winner_right<std::uint16_t>, local_extrema<std::uint16_t>},
    .left_right = left_right,
    .median = median,
    .speckle = speckle,
    .speckle_scratch = speckle_scratch,
    .mask_confidence = mask_confidence,
    .interpolate = interpolate,
    .interpolate_scratch = interpolate_scratch,
    .depth = depth,
};

}  // namespace disparityd::reference
