// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/vm/camera/camera_model.h"
#include "tests/vm/camera/file_descriptor.h"

namespace simulated_camera {

/// Plugs a device into a free port of the kernel's virtual USB controller (module vhci-hcd): gives back the device's
/// end of a connection that speaks USB/IP. Closing it unplugs. Throws std::runtime_error without such a controller or
/// port.
FileDescriptor plug_into_virtual_port(Link link);

}  // namespace simulated_camera
