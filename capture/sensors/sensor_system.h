// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/waker.h"
#include "capture/sensors/sensor_device.h"

namespace disparityd::capture {

/// What the sensors of a camera need of the system, so that tests can put scripted ones and a clock of their own in its
/// place. Nothing throws but devices().
class SensorSystem {
public:
    virtual ~SensorSystem() = default;

    virtual std::vector<SensorDevice> devices() = 0;

    /// A descriptor that never blocks, or -errno.
    virtual int open(const std::string& node) = 0;
    virtual void close(int device) = 0;

    /// Reads one report and returns its bytes, or -errno; -EAGAIN when none waits.
    virtual int read(int device, std::span<std::uint8_t> report) = 0;

    /// Sends a feature report and returns 0 or errno. Waits for the device, some seconds when it hangs.
    virtual int send(int device, std::span<const std::uint8_t> report) = 0;

    /// As base::wait_for_device(), by the clock of now().
    virtual base::Wakening wait(int device, base::Waker& waker, std::chrono::steady_clock::time_point deadline) = 0;

    virtual std::chrono::steady_clock::time_point now() = 0;
    virtual std::int64_t realtime_ns() = 0;
};

/// Returns this machine's sensors, through hidraw; one object for all.
SensorSystem& linux_sensor_system();

}  // namespace disparityd::capture
