// SPDX-License-Identifier: Apache-2.0
#include "capture/usb_camera.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>

#include "capture/text_file.h"

namespace disparityd::capture {

namespace {

namespace fs = std::filesystem;

std::string attribute(const fs::path& folder, const char* name) {
    std::ifstream file(folder / name);
    std::string line;
    std::getline(file, line);
    return std::string(trim(line));
}

int number(const std::string& text, int base) {
    int value = 0;
    std::from_chars(text.data(), text.data() + text.size(), value, base);
    return value;
}

/// The USB device that a video device is an interface of; empty for others.
fs::path usb_folder(const fs::path& video) {
    std::error_code error;
    const fs::path interface = fs::canonical(video / "device", error);
    if (error) {
        return {};
    }
    for (const fs::path& folder : {interface, interface.parent_path()}) {
        if (fs::exists(folder / "idVendor", error)) {
            return folder;
        }
    }
    return {};
}

void read_usb(const fs::path& folder, UsbCamera& camera) {
    camera.port = folder.filename().string();
    camera.vendor = static_cast<std::uint16_t>(number(attribute(folder, "idVendor"), 16));
    camera.product = static_cast<std::uint16_t>(number(attribute(folder, "idProduct"), 16));
    camera.firmware = static_cast<std::uint16_t>(number(attribute(folder, "bcdDevice"), 16));
    camera.serial = attribute(folder, "serial");
    camera.speed_mbit = parse_number(attribute(folder, "speed")).value_or(0);
    camera.bus = number(attribute(folder, "busnum"), 10);
    camera.address = number(attribute(folder, "devnum"), 10);
    camera.autosuspend = attribute(folder, "power/control") == "auto";
    if (camera.name.empty()) {
        camera.name = attribute(folder, "product");
    }
}

/// Folders of a class or bus; none when it is not there.
std::vector<fs::path> folders(const fs::path& parent) {
    std::vector<fs::path> list;
    std::error_code error;
    for (fs::directory_iterator entry(parent, error), end; !error && entry != end; entry.increment(error)) {
        list.push_back(entry->path());
    }
    return list;
}

/// "video10" after "video9".
bool node_before(const UsbCamera& a, const UsbCamera& b) {
    return a.node.size() != b.node.size() ? a.node.size() < b.node.size() : a.node < b.node;
}

}  // namespace

std::string UsbCamera::model() const {
    const ZedCamera* known = zed();
    return known != nullptr ? std::string(known->model) : name.empty() ? "camera" : name;
}

std::string UsbCamera::label(const std::string& known_serial) const {
    const std::string& shown = known_serial.empty() ? serial : known_serial;
    std::string text;
    const auto add = [&text](const char* what, const std::string& value) {
        if (!value.empty()) {
            text += (text.empty() ? "" : ", ") + std::string(what) + value;
        }
    };
    add("serial ", shown);
    add("", node);
    add("USB port ", port);
    return model() + (text.empty() ? "" : " (" + text + ")");
}

bool same_plugging(const UsbCamera& a, const UsbCamera& b) {
    return a.node == b.node && a.port == b.port && a.address == b.address && a.product == b.product;
}

std::vector<UsbCamera> list_cameras(const std::string& sys, const std::string& dev) {
    std::vector<UsbCamera> cameras;
    for (const fs::path& video : folders(fs::path(sys) / "class/video4linux")) {
        const std::string node = video.filename().string();
        const std::string index = attribute(video, "index");
        // Further nodes of a camera carry metadata, no pictures.
        if (!node.starts_with("video") || (!index.empty() && index != "0")) {
            continue;
        }
        UsbCamera camera;
        camera.node = (fs::path(dev) / node).string();
        camera.name = attribute(video, "name");
        if (const fs::path usb = usb_folder(video); !usb.empty()) {
            read_usb(usb, camera);
        }
        cameras.push_back(std::move(camera));
    }
    std::sort(cameras.begin(), cameras.end(), node_before);
    for (const fs::path& usb : folders(fs::path(sys) / "bus/usb/devices")) {
        if (number(attribute(usb, "idVendor"), 16) != zed_vendor) {
            continue;
        }
        UsbCamera camera;
        read_usb(usb, camera);
        const bool listed = std::any_of(cameras.begin(), cameras.end(),
                                        [&](const UsbCamera& other) { return other.port == camera.port; });
        if (camera.zed() != nullptr && !listed) {
            cameras.push_back(std::move(camera));
        }
    }
    return cameras;
}

}  // namespace disparityd::capture
