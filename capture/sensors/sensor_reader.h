// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "base/waker.h"
#include "capture/sensor_sample.h"
#include "capture/sensors/sensor_stream.h"
#include "capture/sensors/sensor_system.h"
#include "capture/source_condition.h"
#include "capture/usb/usb_camera.h"

namespace disparityd::capture {

/// Reads the sensors of a live camera in a thread of its own, so that no frame waits for them and each sample gets its
/// arrival time at once. Samples wait in a ring of fixed size; when it is full, the oldest is dropped and counted.
class SensorReader {
public:
    /// `system` must outlive the reader; `report` is called in the reader's thread.
    SensorReader(SensorSystem& system, std::function<void(const std::string& line, bool trouble)> report);
    ~SensorReader();
    SensorReader(const SensorReader&) = delete;
    SensorReader& operator=(const SensorReader&) = delete;

    /// Sets the camera whose sensors are read from now on; nullopt: none. Does not wait; any thread.
    void follow(const std::optional<UsbCamera>& camera);

    /// Moves waiting samples, the oldest first, and returns how many. One thread; allocates nothing.
    std::size_t take(std::span<SensorSample> to);

    /// Returns nullopt while no camera with sensors is followed. Any thread.
    std::optional<SensorFacts> facts() const;

    static constexpr std::size_t most_waiting = 2048;

private:
    void run() noexcept;
    void step();
    void keep(const SensorSample& sample);

    SensorSystem& system_;
    base::Waker waker_;
    SensorStream stream_;  ///< the thread's
    std::atomic<bool> stopping_{false};

    mutable std::mutex mutex_;  ///< what follows
    std::optional<UsbCamera> camera_;
    bool camera_changed_ = false;
    SensorFacts facts_;
    std::vector<SensorSample> ring_;
    std::size_t first_ = 0;
    std::size_t waiting_ = 0;
    std::uint64_t lost_ = 0;

    std::thread thread_;
};

}  // namespace disparityd::capture
