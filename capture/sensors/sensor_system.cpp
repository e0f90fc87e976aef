// SPDX-License-Identifier: Apache-2.0
#include "capture/sensors/sensor_system.h"

#include <algorithm>
#include <array>
#include <cerrno>

#include <linux/hidraw.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "base/device_file.h"

namespace disparityd::capture {

namespace {

class LinuxSensorSystem final : public SensorSystem {
public:
    std::vector<SensorDevice> devices() override { return list_sensor_devices(); }
    int open(const std::string& node) override { return base::open_device(node); }
    void close(int device) override { ::close(device); }

    int read(int device, std::span<std::uint8_t> report) override {
        const ssize_t bytes = ::read(device, report.data(), report.size());
        return bytes < 0 ? -errno : static_cast<int>(bytes);
    }

    int send(int device, std::span<const std::uint8_t> report) override {
        std::array<std::uint8_t, 64> bytes{};
        const std::size_t size = std::min(report.size(), bytes.size());
        std::copy_n(report.begin(), size, bytes.begin());
        return base::device_ioctl(device, HIDIOCSFEATURE(size), bytes.data());
    }

    base::Wakening wait(int device, base::Waker& waker, std::chrono::steady_clock::time_point deadline) override {
        return base::wait_for_device(device, waker, deadline);
    }

    std::chrono::steady_clock::time_point now() override { return std::chrono::steady_clock::now(); }

    std::int64_t realtime_ns() override {
        return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
            .count();
    }
};

}  // namespace

SensorSystem& linux_sensor_system() {
    static LinuxSensorSystem system;
    return system;
}

}  // namespace disparityd::capture
