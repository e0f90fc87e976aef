// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "capture/sensors/sensor_system.h"
#include "tests/capture/sensors/sensor_bytes.h"

namespace disparityd::capture::test {

/// A system with one sensor device that follows a script, and a clock of its own that runs only while somebody waits.
/// The device sends 400 reports a second while it is switched on and hears a ping at least every six seconds.
class FakeSensorSystem final : public SensorSystem {
public:
    FakeSensorSystem() { plug(); }

    void plug() {
        present_ = {{"/dev/hidraw3", "1-1.2", zed_vendor, 0xf781, 0x0308, "12345"}};
        gone_ = false;
        ticks_ = 1000;
    }
    void unplug() {
        present_.clear();
        gone_ = true;
        on_ = false;
        waiting_.clear();
    }

    int open_error = 0;
    int send_error = 0;
    bool frozen = false;
    std::vector<std::uint8_t> next_report;  ///< sent once instead of a right one

    int opened() const { return opened_; }
    int open_devices() const { return open_; }
    int waits() const { return waits_; }

    std::vector<SensorDevice> devices() override { return present_; }

    int open(const std::string& node) override {
        if (open_error != 0 || present_.empty() || node != present_.front().node) {
            return open_error != 0 ? -open_error : -ENOENT;
        }
        ++opened_;
        ++open_;
        gone_ = false;
        return 7;
    }

    void close(int /*device*/) override {
        --open_;
        on_ = false;
        waiting_.clear();
    }

    int read(int /*device*/, std::span<std::uint8_t> report) override {
        if (gone_) {
            return -ENODEV;
        }
        if (waiting_.empty()) {
            return -EAGAIN;
        }
        const auto bytes = waiting_.front();
        waiting_.pop_front();
        std::copy_n(bytes.begin(), std::min(bytes.size(), report.size()), report.begin());
        return static_cast<int>(bytes.size());
    }

    int send(int /*device*/, std::span<const std::uint8_t> report) override {
        if (send_error != 0 || gone_) {
            return gone_ ? ENODEV : send_error;
        }
        const std::vector<std::uint8_t> bytes(report.begin(), report.end());
        if (bytes == std::vector<std::uint8_t>{0x32, 1}) {
            on_ = true;
            next_ = now_;
            pinged_ = now_;
        } else if (bytes == std::vector<std::uint8_t>{0x21, 0xf2}) {
            pinged_ = now_;
        } else {
            return EPIPE;
        }
        return 0;
    }

    base::Wakening wait(int device, base::Waker& waker, std::chrono::steady_clock::time_point deadline) override {
        ++waits_;
        waker.clear();
        const auto period = std::chrono::microseconds(2500);
        while (waiting_.empty() && !(device >= 0 && gone_) && now_ < deadline) {
            const bool sends = on_ && !frozen && now_ < pinged_ + std::chrono::seconds(6);
            now_ = sends ? std::min(deadline, std::max(now_, next_)) : deadline;
            if (sends && now_ >= next_) {
                next_ += period;
                SensorBytes bytes;
                bytes.ticks = ticks_ += 64;
                waiting_.push_back(next_report.empty() ? bytes.report() : std::exchange(next_report, {}));
            }
        }
        return {false, device >= 0 && !waiting_.empty(), device >= 0 && gone_};
    }

    std::chrono::steady_clock::time_point now() override { return now_; }
    std::int64_t realtime_ns() override { return std::chrono::nanoseconds(now_.time_since_epoch()).count() + offset; }

    static constexpr std::int64_t offset = 1'700'000'000'000'000'000;

private:
    std::vector<SensorDevice> present_;
    std::deque<std::vector<std::uint8_t>> waiting_;
    std::chrono::steady_clock::time_point now_{std::chrono::hours(1)};
    std::chrono::steady_clock::time_point next_{};
    std::chrono::steady_clock::time_point pinged_{};
    std::uint64_t ticks_ = 0;
    bool on_ = false;
    bool gone_ = false;
    int opened_ = 0;
    int open_ = 0;
    int waits_ = 0;
};

}  // namespace disparityd::capture::test
