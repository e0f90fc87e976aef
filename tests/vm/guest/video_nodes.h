// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace vm_guest {

/// A USB camera's node for frames (not the one for metadata), as sysfs shows it.
struct VideoNode {
    std::string path;      ///< /dev/videoN
    std::string usb_path;  ///< /sys/... of the USB device
    std::uint16_t product_id;
    int bus;  ///< with `device` the name below /dev/bus/usb
    int device;
};

/// All USB cameras, in order of node numbers.
std::vector<VideoNode> usb_video_nodes();

/// /dev/bus/usb/BBB/DDD of the camera.
std::string usb_node(const VideoNode& node);

/// First line of a file; empty when there is none.
std::string first_line(const std::string& file);

}  // namespace vm_guest
