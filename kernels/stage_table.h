// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

#include "kernels/stage.h"

namespace disparityd {

// The stages with one step have its name.
inline constexpr std::array<std::string_view, 1> rectify_steps = {to_string(StageKind::rectify)};
inline constexpr std::array<std::string_view, 1> census_steps = {to_string(StageKind::census)};
inline constexpr std::array<std::string_view, 1> post_process_steps = {to_string(StageKind::post_process)};

/// Returns the stages of SAD on the processor. `match_steps`, of static life, end with the one that chooses the
/// disparities.
constexpr std::array<StageInfo, 3> sad_stages(std::span<const std::string_view> match_steps) {
    return {{{StageKind::rectify, rectify_steps},
             {StageKind::match, match_steps, match_steps.size() - 1},
             {StageKind::post_process, post_process_steps}}};
}

/// Returns the stages of a method with a census transform; `match_steps` as in sad_stages().
constexpr std::array<StageInfo, 4> census_stages(std::span<const std::string_view> match_steps) {
    return {{{StageKind::rectify, rectify_steps},
             {StageKind::census, census_steps},
             {StageKind::match, match_steps, match_steps.size() - 1},
             {StageKind::post_process, post_process_steps}}};
}

}  // namespace disparityd
