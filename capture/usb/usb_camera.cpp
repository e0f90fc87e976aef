// SPDX-License-Identifier: Apache-2.0
#include "capture/usb/usb_camera.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "base/number_text.h"
#include "capture/usb/sysfs.h"

namespace disparityd::capture {
namespace {

namespace fs = std::filesystem;
using sysfs::attribute;
using sysfs::number;

void read_usb(const fs::path& folder, UsbCamera& camera) {
    camera.port = folder.filename().string();
    camera.vendor = static_cast<std::uint16_t>(number(attribute(folder, "idVendor"), 16));
    camera.product = static_cast<std::uint16_t>(number(attribute(folder, "idProduct"), 16));
    camera.firmware = static_cast<std::uint16_t>(number(attribute(folder, "bcdDevice"), 16));
    camera.serial = attribute(folder, "serial");
    camera.speed_mbit = base::parse_number(attribute(folder, "speed")).value_or(0);
    camera.bus = number(attribute(folder, "busnum"), 10);
    camera.address = number(attribute(folder, "devnum"), 10);
    camera.autosuspend = attribute(folder, "power/control") == "auto";
    if (camera.name.empty()) {
        camera.name = attribute(folder, "product");
    }
}

}  // namespace

bool PluggedCameras::note(const std::vector<UsbCamera>& cameras, Clock::time_point now) {
    std::vector<Plugged> plugged;
    bool came = false;
    for (const UsbCamera& camera : cameras) {
        const Clock::time_point since = this->since(camera);
        const bool known = since != Clock::time_point::min();
        came = came || !known;
        plugged.push_back({camera, known ? since : now});
    }
    plugged_ = std::move(plugged);
    return came;
}

PluggedCameras::Clock::time_point PluggedCameras::since(const UsbCamera& camera) const {
    const auto known = std::find_if(plugged_.begin(), plugged_.end(),
                                    [&](const Plugged& p) { return same_plugging(p.camera, camera); });
    return known == plugged_.end() ? Clock::time_point::min() : known->since;
}

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
    for (const fs::path& video : sysfs::entries(fs::path(sys) / "class/video4linux")) {
        const std::string node = video.filename().string();
        const std::string index = attribute(video, "index");
        // Further nodes of a camera carry metadata, no pictures.
        if (!node.starts_with("video") || (!index.empty() && index != "0")) {
            continue;
        }
        UsbCamera camera;
        camera.node = (fs::path(dev) / node).string();
        camera.name = attribute(video, "name");
        std::error_code error;
        camera.place = fs::canonical(video / "device", error).filename().string();
        if (const fs::path usb = sysfs::usb_device(video / "device"); !usb.empty()) {
            read_usb(usb, camera);
        }
        cameras.push_back(std::move(camera));
    }
    std::sort(cameras.begin(), cameras.end(),
              [](const UsbCamera& a, const UsbCamera& b) { return sysfs::node_before(a.node, b.node); });
    for (const fs::path& usb : sysfs::entries(fs::path(sys) / "bus/usb/devices")) {
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
