// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/vm/camera/camera_model.h"
#include "tests/vm/camera/usb_request.h"

namespace simulated_camera {

Bytes device_descriptor(const CameraOptions& camera);

/// Configuration with everything in it: a control interface (camera terminal, processing unit, extension unit, output
/// terminal) and a streaming interface with the offered modes.
Bytes configuration_descriptor(const CameraOptions& camera);

/// USB 3 cameras only.
Bytes capabilities_descriptor();

/// What a USB 2 camera says about full speed, which it does not have.
Bytes device_qualifier_descriptor();

/// Answers GET_DESCRIPTOR; a stall for a descriptor that the camera does not have.
ControlAnswer find_descriptor(const CameraOptions& camera, std::uint8_t type, std::uint8_t index);

/// Bytes that the isochronous endpoint moves in one interval.
std::uint32_t bytes_per_interval(Link link);

/// The most that one bulk transfer holds, its payload header included.
std::uint32_t bulk_payload_bytes(Link link);

}  // namespace simulated_camera
