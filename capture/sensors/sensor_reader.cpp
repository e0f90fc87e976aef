// SPDX-License-Identifier: Apache-2.0
#include "capture/sensors/sensor_reader.h"

#include <algorithm>
#include <utility>

#include <poll.h>

#include "base/start_thread.h"

namespace disparityd::capture {

namespace {

/// Bounds one sleep of the thread, which is woken for everything.
constexpr std::chrono::seconds longest_sleep{1};

}  // namespace

SensorReader::SensorReader(SensorSystem& system, std::function<void(const std::string&, bool)> report)
    : system_(system),
      stream_(
          system, [this](const SensorSample& sample) { keep(sample); }, std::move(report)),
      ring_(most_waiting) {
    thread_ = base::start_thread([this] { run(); });
}

SensorReader::~SensorReader() {
    stopping_.store(true);
    waker_.wake();
    thread_.join();
}

void SensorReader::follow(const std::optional<UsbCamera>& camera) {
    const bool has_sensors = camera && camera->zed() != nullptr && camera->zed()->sensors != 0;
    const std::lock_guard lock(mutex_);
    if (has_sensors && camera_ && !camera_changed_ && same_plugging(*camera_, *camera)) {
        return;
    }
    if (!has_sensors && !camera_) {
        return;
    }
    camera_ = has_sensors ? camera : std::nullopt;
    facts_ = {};
    facts_.state = SensorState::starting;
    camera_changed_ = true;
    waker_.wake();
}

void SensorReader::run() noexcept {
    while (!stopping_.load()) {
        try {
            step();
        } catch (...) {
            // Memory ran out, most likely. The device is opened anew when there is some.
            {
                const std::lock_guard lock(mutex_);
                facts_.state = SensorState::failed;
                camera_changed_ = true;
            }
            pollfd event{waker_.descriptor(), POLLIN, 0};
            ::poll(&event, 1, static_cast<int>(std::chrono::milliseconds(longest_sleep).count()));
        }
    }
}

void SensorReader::step() {
    std::optional<UsbCamera> camera;
    bool changed = false;
    {
        const std::lock_guard lock(mutex_);
        camera = camera_changed_ ? camera_ : std::nullopt;
        changed = std::exchange(camera_changed_, false);
    }
    if (changed) {
        stream_.follow(std::move(camera));
    }
    stream_.step(waker_, system_.now() + longest_sleep);
    const std::lock_guard lock(mutex_);
    if (!camera_changed_) {
        facts_ = stream_.facts();
    }
}

void SensorReader::keep(const SensorSample& sample) {
    const std::lock_guard lock(mutex_);
    if (waiting_ == ring_.size()) {
        // The next sample also counts what was lost before the oldest one.
        const std::uint32_t lost = ring_[first_].lost_before + 1;
        first_ = (first_ + 1) % ring_.size();
        --waiting_;
        ++lost_;
        ring_[first_].lost_before += lost;
    }
    ring_[(first_ + waiting_) % ring_.size()] = sample;
    ++waiting_;
}

std::size_t SensorReader::take(std::span<SensorSample> to) {
    const std::lock_guard lock(mutex_);
    const std::size_t count = std::min(to.size(), waiting_);
    for (std::size_t i = 0; i < count; ++i) {
        to[i] = ring_[(first_ + i) % ring_.size()];
    }
    first_ = (first_ + count) % ring_.size();
    waiting_ -= count;
    return count;
}

std::optional<SensorFacts> SensorReader::facts() const {
    const std::lock_guard lock(mutex_);
    if (!camera_) {
        return std::nullopt;
    }
    SensorFacts facts = facts_;
    facts.lost = lost_;
    return facts;
}

}  // namespace disparityd::capture
