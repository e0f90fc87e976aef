// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/vm/camera/camera_model.h"
#include "tests/vm/camera/usb_request.h"

namespace simulated_camera {

/// The negotiation before a stream (UVC 1.1, 4.3.1.1): the host proposes with PROBE, the camera answers with the
/// nearest thing it can do, COMMIT settles it.
class StreamSettings {
public:
    explicit StreamSettings(const CameraOptions& camera);

    ControlAnswer answer(const SetupPacket& setup, std::span<const std::uint8_t> data);

    /// What COMMIT settled last.
    const Mode& mode() const;
    std::uint32_t interval() const;  ///< in units of 100 ns

private:
    Bytes nearest(Bytes wish) const;

    CameraOptions camera_;
    Bytes probe_;
    Bytes commit_;
};

/// Whether this request is a COMMIT of new settings.
bool is_commit(const SetupPacket& setup);

}  // namespace simulated_camera
