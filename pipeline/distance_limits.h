// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <string_view>

#include "kernels/added_stage.h"

namespace disparityd::pipeline {

/// Between which distances along the optical axis frames are served, in metres.
struct DistanceLimits {
    double min_m = 0;  ///< 0: no limit
    double max_m = 0;  ///< 0: no limit

    bool any() const { return min_m > 0 || max_m > 0; }
};

/// How people give the limits, for what a stage tells of them.
struct DistanceLimitNames {
    std::string_view min = "[output] min_distance_m";
    std::string_view max = "[output] max_distance_m";
};

/// Rejects what was measured nearer or farther, in all planes of a frame. Records have been made by then: they see
/// everything.
class DistanceLimitStage final : public AddedStage {
public:
    /// `range` is what frames are matched with. Lengths become whole millimetres.
    DistanceLimitStage(const DistanceLimits& limits, DisparityRange range, const DistanceLimitNames& names = {});

    std::string_view name() const override { return "distance-limits"; }
    StagePlace place() const override { return StagePlace::served; }
    bool depends_on_earlier_frames() const override { return false; }
    void run(const StageFrame& frame, Parallel& workers) override;
    /// Tells of limits that change nothing, or leave nothing.
    std::string notice() const override;

private:
    enum class Effect : std::uint8_t { as_wanted, no_distances, min_too_near, max_too_far, no_effect, nothing_left };

    void set(const DepthScale& scale);
    Effect effect_of(const DepthScale& scale) const;

    DistanceLimits limits_;
    DisparityRange range_;
    DistanceLimitNames names_;
    DepthScale scale_;  ///< of what follows
    // Disparities with the offset, 1/16 px, that are served.
    int least_ = 0;
    int most_ = 0;
    std::atomic<Effect> effect_{Effect::as_wanted};
};

}  // namespace disparityd::pipeline
