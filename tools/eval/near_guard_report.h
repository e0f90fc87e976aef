// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "kernels/matcher.h"
#include "kernels/near_plane.h"
#include "tools/eval/scene.h"
#include "tools/images/disparity_map.h"

namespace disparityd::eval {

/// What the near guard does to a scene. *Nearer* are pixels whose truth is at least d_min + D, *farther* those up to
/// the last candidate; sectors are 24 columns wide, and near where 1 % of their pixels is.
struct NearGuardCounts {
    std::size_t pixels = 0;   ///< all of the image
    std::size_t flagged = 0;  ///< of all
    std::size_t nearer = 0;
    std::size_t nearer_measured_without = 0;  ///< without the guard
    std::size_t nearer_measured = 0;
    std::size_t nearer_flagged = 0;
    std::size_t nearer_flagged_right = 0;  ///< with a value within 10 % of the truth
    std::size_t farther = 0;
    std::size_t farther_flagged = 0;
    std::size_t sectors = 0;
    std::size_t sectors_flagged = 0;
    std::size_t sectors_nearer = 0;
    std::size_t sectors_found = 0;  ///< of those that are nearer

    void add(const NearGuardCounts& other);
};

/// Counts over one image. `without` and `with`: confidences of the matcher without and with the guard; `near`: what the
/// guard has found, as FrameView::near.
NearGuardCounts count_near(const images::FloatMap& truth, DisparityRange range, Plane<const std::uint8_t> without,
                           Plane<const std::uint8_t> with, Plane<const std::int16_t> near);

/// What `disparity-eval --near-guard DATA` runs.
struct NearGuardEvaluation {
    std::vector<SceneToJudge> scenes;
    std::function<MatchOptions(int disparities)> match;
    const Backend* backend = nullptr;
};

/// Matches each scene with all candidates that it needs, with a half and with a quarter of them (multiples of 16 that
/// are fewer), and prints a table: a row for each scene and range, then all of a range. Shows progress; a Ctrl-C ends
/// it. Throws std::invalid_argument as the scenes do.
void report_near_guard(const NearGuardEvaluation& evaluation, Parallel& workers, bool markdown);

}  // namespace disparityd::eval
