// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "capture/camera/video_system.h"
#include "capture/camera_setting.h"

namespace disparityd::capture {

/// "gain-left=30 auto-exposure=0"; `where` is for messages. Throws std::invalid_argument.
std::vector<CameraSetting> parse_camera_settings(const std::string& text, const std::string& where);

/// Sets controls in this order, then reads all: those of V4L2 and, of a ZED, those behind its extension unit
/// ("auto-exposure", "exposure-left", "exposure-right", "gain-left", "gain-right"; exposure in lines, gain as the
/// sensor counts it). Opens the node by itself: a stream of somebody else goes on. Nothing is set when a name is not
/// known or a value out of range. Throws std::invalid_argument for those, std::runtime_error when the camera refuses.
std::vector<CameraControl> control_camera(VideoSystem& system, const UsbCamera& camera, double rate,
                                          const std::vector<CameraSetting>& settings);

/// Controls that were set on a live camera while it ran. They are set again whenever the camera is opened: after an
/// unplugging, after a reset, or by the source that takes this one's place. An override ends when its control is
/// configured anew with another value. Any thread.
class ControlOverrides {
public:
    /// Remembers settings. `configured` is what holds without them; the latest setting of a name counts.
    void note(const std::vector<CameraSetting>& settings, const std::vector<CameraSetting>& configured);

    /// Returns what is to be set after `configured`, in the order in which it was set. Forgets overrides of controls
    /// whose configured value has changed; a control that is no longer configured keeps its override.
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
