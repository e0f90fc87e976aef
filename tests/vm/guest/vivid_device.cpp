// SPDX-License-Identifier: Apache-2.0
#include "tests/vm/guest/vivid_device.h"

#include <filesystem>
#include <stdexcept>

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>

#include "tests/vm/camera/file_descriptor.h"
#include "tests/vm/guest/video_nodes.h"

namespace vm_guest {

std::string vivid_node(int device) {
    const std::string name = "vivid-00" + std::to_string(device);
    for (const auto& entry : std::filesystem::directory_iterator("/sys/class/video4linux")) {
        if (first_line(entry.path() / "name").starts_with(name)) {
            return "/dev/" + entry.path().filename().string();
        }
    }
    throw std::runtime_error("no node " + name);
}

void set_vivid(const std::string& control, int value, int device) {
    const simulated_camera::FileDescriptor file(::open(vivid_node(device).c_str(), O_RDWR | O_CLOEXEC));
    v4l2_queryctrl query{};
    query.id = V4L2_CTRL_FLAG_NEXT_CTRL;
    while (::ioctl(file.get(), VIDIOC_QUERYCTRL, &query) == 0) {
        if (reinterpret_cast<const char*>(query.name) == control) {
            v4l2_control setting{query.id, value};
            if (::ioctl(file.get(), VIDIOC_S_CTRL, &setting) != 0) {
                throw std::runtime_error("vivid refuses " + control);
            }
            return;
        }
        query.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
    }
    throw std::runtime_error("vivid has no control " + control);
}

}  // namespace vm_guest
