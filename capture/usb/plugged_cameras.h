// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <vector>

#include "capture/usb/usb_camera.h"

namespace disparityd::capture {

/// Remembers since when each camera that is there is plugged in. One thread.
class PluggedCameras {
public:
    using Clock = std::chrono::steady_clock;

    /// Takes the cameras that are there now. Returns whether one has come, or come again, since the last call.
    bool note(const std::vector<UsbCamera>& cameras, Clock::time_point now);

    /// Returns when the camera was first noted in this plugging; the least time for one that was not.
    Clock::time_point since(const UsbCamera& camera) const;

private:
    struct Plugged {
        UsbCamera camera;
        Clock::time_point since;
    };

    std::vector<Plugged> plugged_;
};

}  // namespace disparityd::capture
