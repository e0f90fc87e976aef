// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "capture/camera/camera_problem.h"
#include "capture/camera/camera_uri.h"
#include "kernels/raw_image.h"

namespace disparityd::capture {

/// Knows which camera each eye of a pair had, so that two that are plugged in anew never exchange the eyes: the kernel
/// may give each the node of the other. An eye's camera is known by its serial number where the other one has another,
/// else by the place where it is plugged in. One thread uses an object.
class EyeCameras {
public:
    /// `pair` names a camera for each eye.
    explicit EyeCameras(const CameraRequest& pair);

    struct Choice {
        std::vector<UsbCamera> cameras;        ///< those that may be opened for the eye
        std::optional<CameraProblem> problem;  ///< why there is none, where that is more than that none is there
    };
    /// Says which of the cameras that are there may be an eye's. A camera that both eyes may mean is none.
    Choice choose(Eye eye, const std::vector<UsbCamera>& present) const;

    /// Returns the camera that is probably an eye's, before any was opened.
    std::optional<UsbCamera> likely(Eye eye, const std::vector<UsbCamera>& present) const;

    /// Says that there is one camera where two are needed.
    static std::string one_camera_text(const UsbCamera& camera);

    void opened(Eye eye, const UsbCamera& camera);
    void unplugged(Eye eye);

private:
    struct Known {
        CameraRequest request;
        std::optional<UsbCamera> camera;  ///< opened last
        bool held = false;                ///< not unplugged since
    };

    static bool is_held(const Known& known, const std::vector<UsbCamera>& present);
    Choice choose_again(Eye eye, const std::vector<UsbCamera>& present, std::vector<UsbCamera> named) const;

    const Known& of(Eye eye) const { return eyes_[static_cast<std::size_t>(eye)]; }

    std::array<Known, 2> eyes_;
};

/// Which eye of which pair a camera is for; none where it has both eyes.
struct EyeOfPair {
    EyeCameras* cameras = nullptr;
    Eye eye = Eye::left;
};

}  // namespace disparityd::capture
