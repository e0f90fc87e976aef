// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

namespace disparityd {

/// The stages that a matcher may have, in the order in which a frame passes them.
enum class StageKind : unsigned char {
    rectify,       ///< raw frame to rectified pair
    census,        ///< rectified pair to census words
    match,         ///< costs, aggregation and winners; on a GPU all but rectify
    post_process,  ///< winners to disparity, confidence and depth
};

/// The name that status, logs and threads show: "rectify", "census", "match", "post-process".
constexpr std::string_view to_string(StageKind kind) {
    constexpr std::array<std::string_view, 4> names = {"rectify", "census", "match", "post-process"};
    return names[static_cast<std::size_t>(kind)];
}

/// What one stage of a matcher consists of. A stage whose parts cannot be timed apart (fused kernels) has one step with
/// the joined names, such as "dsi+aggregate+wta".
struct StageInfo {
    StageKind kind = StageKind::match;
    std::span<const std::string_view> steps;
    std::size_t winner_step = 0;  ///< index of the step that chooses the disparities; of a stage `match`
};

}  // namespace disparityd
