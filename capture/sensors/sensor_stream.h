// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "capture/sensor_sample.h"
#include "capture/sensors/sensor_clock.h"
#include "capture/sensors/sensor_system.h"
#include "capture/source_condition.h"
#include "capture/usb/usb_camera.h"

namespace disparityd::capture {

/// Keeps the sensors of one camera sending. It finds and opens their device, asks for reports, and pings the device
/// twice a second. It opens a silent device anew, and looks for one that has gone. One thread, which sleeps in step().
class SensorStream {
public:
    using Time = std::chrono::steady_clock::time_point;
    using Sink = std::function<void(const SensorSample&)>;

    /// `report` hears what happens, one line each.
    SensorStream(SensorSystem& system, Sink sink, std::function<void(const std::string& line, bool trouble)> report)
        : system_(system), sink_(std::move(sink)), report_(std::move(report)) {}
    ~SensorStream() { follow(std::nullopt); }
    SensorStream(const SensorStream&) = delete;
    SensorStream& operator=(const SensorStream&) = delete;

    /// Sets the camera whose sensors are meant from now on; nullopt: none. Closes the device of the one before.
    void follow(std::optional<UsbCamera> camera);

    /// Does what is due and takes what has come; waits for that until the deadline or until the waker is woken.
    void step(base::Waker& waker, Time deadline);

    const SensorFacts& facts() const { return facts_; }

private:
    void look_for_device();
    void set_state_unless_new(SensorState state, const std::string& detail);
    void set_state(SensorState state, const std::string& detail);
    void take_reports();
    void take(std::span<const std::uint8_t> report);
    void ping();
    void close();
    void close_and_retry();

    SensorSystem& system_;
    Sink sink_;
    std::function<void(const std::string& line, bool trouble)> report_;
    std::optional<UsbCamera> camera_;
    SensorDevice device_;
    int handle_ = -1;
    SensorClock clock_;
    SensorFacts facts_;
    std::string detail_;  ///< the line that was reported last
    Time followed_{};
    Time retry_at_{};
    Time ping_at_{};
    Time last_sample_{};
};

}  // namespace disparityd::capture
