// SPDX-License-Identifier: Apache-2.0
#include "tests/vm/guest/video_nodes.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace vm_guest {

namespace {

int number_in(const std::string& file, int base) {
    return static_cast<int>(std::strtol(first_line(file).c_str(), nullptr, base));
}

int node_number(const VideoNode& node) {
    return std::atoi(node.path.c_str() + std::string("/dev/video").size());
}

}  // namespace

std::string first_line(const std::string& file) {
    std::ifstream stream(file);
    std::string line;
    std::getline(stream, line);
    return line;
}

std::vector<VideoNode> usb_video_nodes() {
    std::vector<VideoNode> nodes;
    std::error_code none;
    for (const auto& entry : std::filesystem::directory_iterator("/sys/class/video4linux", none)) {
        // The link leads to the USB interface; the device lies above it.
        const std::string usb = std::filesystem::weakly_canonical(entry.path() / "device", none).parent_path().string();
        const std::string node = "/dev/" + entry.path().filename().string();
        const bool is_usb = std::filesystem::exists(usb + "/idProduct", none);
        if (is_usb && first_line(entry.path() / "index") == "0" && std::filesystem::exists(node, none)) {
            nodes.push_back({node, usb, static_cast<std::uint16_t>(number_in(usb + "/idProduct", 16)),
                             number_in(usb + "/busnum", 10), number_in(usb + "/devnum", 10)});
        }
    }
    std::sort(nodes.begin(), nodes.end(),
              [](const VideoNode& a, const VideoNode& b) { return node_number(a) < node_number(b); });
    return nodes;
}

std::string usb_node(const VideoNode& node) {
    char path[64];
    std::snprintf(path, sizeof path, "/dev/bus/usb/%03d/%03d", node.bus, node.device);
    return path;
}

}  // namespace vm_guest
