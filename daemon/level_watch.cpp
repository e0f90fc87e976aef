// SPDX-License-Identifier: Apache-2.0
#include "daemon/level_watch.h"

#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "proto/scan.h"

namespace disparityd::daemon {
namespace {

constexpr int most_samples = 64;
constexpr std::uint32_t oldest_us = 1'000'000;

/// Another client may give levels when the one before has given none for so long: two autopilots are not mixed.
constexpr std::chrono::seconds silence{1};

struct TimedLevel {
    std::int64_t monotonic_ns;
    scan::RobotUp up;
};

TimedLevel checked(const v1::LevelSample& sample, LevelWatch::Time now) {
    const auto up = scan::checked_up({sample.ahead(), sample.left(), sample.up()});
    if (!up) {
        throw std::invalid_argument(fmt::format("level: found ({}, {}, {}), allowed: a direction of length 1",
                                                sample.ahead(), sample.left(), sample.up()));
    }
    if (sample.age_us() > oldest_us) {
        throw std::invalid_argument(
            fmt::format("level: found an age of {} us, allowed: at most {}", sample.age_us(), oldest_us));
    }
    const auto measured = now - std::chrono::microseconds(sample.age_us());
    return {std::chrono::nanoseconds(measured.time_since_epoch()).count(), *up};
}

}  // namespace

void LevelWatch::take(const v1::GiveLevel& message, std::uint64_t client, Time now) {
    if (ground_ != GroundMode::autopilot) {
        throw std::invalid_argument(fmt::format("level: found {}, allowed: [scan] ground = \"autopilot\"",
                                                ground_ ? fmt::format("ground = \"{}\"", to_string(*ground_))
                                                        : std::string("no obstacle scan ([scan] enabled)")));
    }
    if (!live_) {
        throw std::invalid_argument("level: found a replay, allowed: a live source; what is told now is not of then");
    }
    if (message.samples_size() < 1 || message.samples_size() > most_samples) {
        throw std::invalid_argument(
            fmt::format("level: found {} samples, allowed: 1 to {}", message.samples_size(), most_samples));
    }
    std::vector<TimedLevel> levels;
    for (const v1::LevelSample& sample : message.samples()) {
        levels.push_back(checked(sample, now));
    }
    {
        const std::lock_guard lock(mutex_);
        if (giver_ && giver_ != client && now - given_at_ < silence) {
            throw std::invalid_argument("level: another client gives it, allowed: one at a time");
        }
        giver_ = client;
        given_at_ = now;
    }
    for (const TimedLevel& level : levels) {
        given_.add(level.monotonic_ns, level.up);
    }
}

void LevelWatch::note(const Plane<const std::uint8_t>& scan, Time now) noexcept {
    if (scan.data == nullptr || !ground_) {
        return;
    }
    const auto source = reinterpret_cast<const proto::ScanHead*>(scan.data)->ground;
    const bool level = source == proto::GroundSource::gravity || source == proto::GroundSource::autopilot;
    known_.store(level, std::memory_order_relaxed);
    if (level) {
        level_ns_.store(now.time_since_epoch().count(), std::memory_order_relaxed);
    }
}

std::optional<v1::LevelStatus> LevelWatch::status(Time now) const {
    if (ground_ != GroundMode::gravity && ground_ != GroundMode::autopilot) {
        return std::nullopt;
    }
    v1::LevelStatus status;
    if (known_.load(std::memory_order_relaxed)) {
        status.set_source(ground_ == GroundMode::gravity ? "inertial" : "autopilot");
    }
    const std::int64_t newest =
        ground_ == GroundMode::gravity ? level_ns_.load(std::memory_order_relaxed) : given_.newest_ns().value_or(0);
    if (newest != 0) {
        status.set_age_ms(std::chrono::duration<double, std::milli>(now.time_since_epoch()).count() -
                          static_cast<double>(newest) / 1e6);
    }
    return status;
}

}  // namespace disparityd::daemon
