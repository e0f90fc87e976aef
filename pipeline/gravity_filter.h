// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "capture/frame_source.h"
#include "kernels/added_stage.h"

namespace disparityd::pipeline {

/// Finds out where up is from what the camera's inertial sensor measures: a low-pass of the acceleration, by the
/// samples' own times. Step 14 of docs/algorithm.md has the numbers. The same samples give the same directions. One
/// thread; allocates nothing.
class GravityFilter {
public:
    /// Takes the samples that came with a frame, in order. Any values may come, as those of a damaged recording.
    void add(std::span<const capture::SensorSample> samples);

    /// Returns where up is for a frame of this time, CLOCK_MONOTONIC as the samples' times. Returns nothing when the
    /// sensor has been silent or shaken for a second, or has not measured long enough yet.
    std::optional<SensorDirection> up_at(std::int64_t monotonic_ns) const;

private:
    void add(const capture::SensorSample& sample);

    bool begun_ = false;
    std::int64_t newest_ns_ = 0;       ///< of all samples with an acceleration
    std::int64_t newest_calm_ns_ = 0;  ///< of those that counted
    SensorDirection sum_;              ///< of accelerations, by weight and age
    double weight_ = 0;                ///< of the sum, s
};

}  // namespace disparityd::pipeline
