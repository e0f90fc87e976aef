// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "capture/camera_controls.h"

namespace disparityd::capture {

/// What was set on a live camera while it ran, kept for whenever it is opened again: after an unplugging, a reset, or
/// by another source that takes this one's place. It holds until something else is configured for that very control
/// than when it was set. Any thread.
class SetControls {
public:
    /// `configured` is what holds without this; the latest setting of a name counts.
    void note(const std::vector<CameraSetting>& settings, const std::vector<CameraSetting>& configured);

    /// What is still to be set after `configured`, in the order in which it was set. Settings for whose control
    /// something else is configured by now are forgotten; a control that is no longer configured is not something else.
    std::vector<CameraSetting> in_force(const std::vector<CameraSetting>& configured);

private:
    struct Noted {
        CameraSetting setting;
        std::optional<std::int64_t> configured;
    };

    std::mutex mutex_;
    std::vector<Noted> noted_;
};

}  // namespace disparityd::capture
