// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "daemon/config/config.h"
#include "kernels/added_stage.h"
#include "obstacles/given_levels.h"
#include "proto/disparity.pb.h"

namespace disparityd::daemon {

/// A stage that a configuration adds to those of the matcher.
struct ConfiguredStage {
    v1::Product product = v1::PRODUCT_NONE;  ///< which its record is; none where it changes planes
    std::unique_ptr<AddedStage> stage;
    /// What its record, the stage's memory of a frame, adds to the frame's flags; null where it adds none.
    std::uint32_t (*flags)(std::span<const std::byte> record) = nullptr;
};

/// Makes the stages that a configuration wants, in the order of the table. Width and height are those of the rectified
/// image; `levels` outlive the stages, null: no autopilot tells any. Throws std::invalid_argument when the user must
/// change something.
std::vector<ConfiguredStage> make_stages(const Config& config, int width, int height, const scan::GivenLevels* levels);

}  // namespace disparityd::daemon
