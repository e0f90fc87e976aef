// SPDX-License-Identifier: Apache-2.0
#include "capture/sensors/sensor_device.h"

#include <algorithm>
#include <filesystem>

#include "capture/usb/sysfs.h"

namespace disparityd::capture {

namespace {

namespace fs = std::filesystem;

std::string without_zeros(const std::string& serial) {
    return serial.substr(std::min(serial.find_first_not_of('0'), serial.size()));
}

/// Returns the path from the controller to the hub. A USB 3 hub is a second hub for USB 2, on another bus.
std::string hub_of(const std::string& port) {
    const std::size_t bus_end = port.find('-');
    const std::size_t hub_end = port.rfind('.');
    return bus_end == std::string::npos || hub_end == std::string::npos
               ? std::string()
               : port.substr(bus_end + 1, hub_end - bus_end - 1);
}

std::optional<SensorDevice> only(const std::vector<SensorDevice>& devices) {
    return devices.size() == 1 ? std::optional(devices.front()) : std::nullopt;
}

}  // namespace

std::vector<SensorDevice> list_sensor_devices(const std::string& sys, const std::string& dev) {
    std::vector<SensorDevice> devices;
    for (const fs::path& hidraw : sysfs::entries(fs::path(sys) / "class/hidraw")) {
        const fs::path usb = sysfs::usb_device(hidraw / "device");
        if (usb.empty() || sysfs::number(sysfs::attribute(usb, "idVendor"), 16) != zed_vendor) {
            continue;
        }
        SensorDevice device;
        device.node = (fs::path(dev) / hidraw.filename()).string();
        device.port = usb.filename().string();
        device.vendor = zed_vendor;
        device.product = static_cast<std::uint16_t>(sysfs::number(sysfs::attribute(usb, "idProduct"), 16));
        device.firmware = static_cast<std::uint16_t>(sysfs::number(sysfs::attribute(usb, "bcdDevice"), 16));
        device.serial = sysfs::attribute(usb, "serial");
        devices.push_back(std::move(device));
    }
    std::sort(devices.begin(), devices.end(),
              [](const SensorDevice& a, const SensorDevice& b) { return sysfs::node_before(a.node, b.node); });
    return devices;
}

std::optional<SensorDevice> sensors_of(const UsbCamera& camera, const std::vector<SensorDevice>& devices) {
    const ZedCamera* zed = camera.zed();
    std::vector<SensorDevice> possible;
    for (const SensorDevice& device : devices) {
        if (zed == nullptr || zed->sensors == 0 || device.vendor != zed_vendor || device.product != zed->sensors) {
            continue;
        }
        const bool both_known = !camera.serial.empty() && !device.serial.empty();
        const bool same = without_zeros(camera.serial) == without_zeros(device.serial);
        if (both_known && same) {
            return device;
        }
        if (!both_known) {
            possible.push_back(device);
        }
    }
    if (possible.size() > 1) {
        std::erase_if(possible, [&camera](const SensorDevice& device) {
            return hub_of(device.port).empty() || hub_of(device.port) != hub_of(camera.port);
        });
    }
    return only(possible);
}

}  // namespace disparityd::capture
