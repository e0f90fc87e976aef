// SPDX-License-Identifier: Apache-2.0
#include "capture/sensors/sensor_stream.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "base/failure_text.h"
#include "capture/sensors/sensor_report.h"

namespace disparityd::capture {

namespace {

using namespace std::chrono_literals;

constexpr auto retry_interval = 500ms;
/// The camera stops six seconds after the last ping.
constexpr auto ping_interval = 500ms;
constexpr auto silence_limit = 2s;
/// The device may come so long after its camera, and be prepared by udev.
constexpr auto arrival_time = 3s;
/// As many reports as the kernel keeps: a flood of them must not keep the thread from the rest.
constexpr int reports_at_once = 64;

}  // namespace

void SensorStream::follow(std::optional<UsbCamera> camera) {
    // The reports are not stopped: the camera stops without pings, and another program may have begun to listen.
    close();
    camera_ = std::move(camera);
    followed_ = system_.now();
    retry_at_ = followed_;
    facts_.state = camera_ ? SensorState::starting : SensorState::absent;
    facts_.detail.clear();
    detail_.clear();
}

void SensorStream::step(base::Waker& waker, Time deadline) {
    const Time now = system_.now();
    if (!camera_) {
        system_.wait(-1, waker, deadline);
        return;
    }
    if (handle_ < 0) {
        if (now >= retry_at_) {
            look_for_device();
        } else {
            system_.wait(-1, waker, std::min(deadline, retry_at_));
        }
        return;
    }
    if (now >= ping_at_) {
        ping();
    }
    const Time silent_at = last_sample_ + silence_limit;
    if (now >= silent_at) {
        set_state(SensorState::silent, "the sensors of " + camera_->label() + " send nothing; they are opened anew");
        close_and_retry();
        return;
    }
    const auto wakening = system_.wait(handle_, waker, std::min({deadline, ping_at_, silent_at}));
    if (wakening.readable) {
        take_reports();
    } else if (wakening.failed) {
        close_and_retry();
    }
}

void SensorStream::look_for_device() {
    retry_at_ = system_.now() + retry_interval;
    const auto found = sensors_of(*camera_, system_.devices());
    if (!found) {
        set_state_unless_new(
            SensorState::absent,
            "the sensors of " + camera_->label() + " are not there: its USB 2 lines may be broken; try another cable");
        return;
    }
    device_ = *found;
    const int handle = system_.open(device_.node);
    if (handle < 0) {
        const bool forbidden = handle == -EACCES || handle == -EPERM;
        set_state_unless_new(forbidden ? SensorState::no_permission : SensorState::failed,
                             "the sensors of " + camera_->label() + ": cannot open " + device_.node + ": " +
                                 base::error_text(-handle) + (forbidden ? ": install disparityd's udev rule" : ""));
        return;
    }
    handle_ = handle;
    facts_.node = device_.node;
    clock_.forget();
    if (const int code = system_.send(handle_, sensor_stream_on); code != 0) {
        set_state_unless_new(SensorState::failed, "the sensors of " + camera_->label() + " (" + device_.node +
                                                      ") refuse to start: " + base::error_text(code));
        close();
        return;
    }
    last_sample_ = system_.now();
    ping_at_ = last_sample_ + ping_interval;
}

/// A device that has just been plugged in may need a moment: it is not reported yet.
void SensorStream::set_state_unless_new(SensorState state, const std::string& detail) {
    if (system_.now() >= followed_ + arrival_time) {
        set_state(state, detail);
    }
}

void SensorStream::set_state(SensorState state, const std::string& detail) {
    facts_.state = state;
    facts_.detail = detail;
    const std::string line = state == SensorState::streaming ? "sensors of " + camera_->label() + " send" : detail;
    if (line != detail_) {
        detail_ = line;
        report_(line, state != SensorState::streaming);
    }
}

void SensorStream::take_reports() {
    std::array<std::uint8_t, 256> report{};
    for (int i = 0; i < reports_at_once; ++i) {
        const int bytes = system_.read(handle_, report);
        if (bytes == -EAGAIN || bytes == -EINTR) {
            return;
        }
        if (bytes <= 0) {
            close_and_retry();
            return;
        }
        take(std::span(report).first(static_cast<std::size_t>(bytes)));
    }
}

void SensorStream::take(std::span<const std::uint8_t> report) {
    const Time now = system_.now();
    auto sample = parse_sensor_report(report, device_.firmware);
    if (!sample) {
        ++facts_.refused;
        return;
    }
    last_sample_ = now;
    const std::int64_t arrived = std::chrono::nanoseconds(now.time_since_epoch()).count();
    const auto measured = clock_.map(sample->camera_ns, arrived);
    facts_.clock_jumps = clock_.jumps();
    facts_.drift = clock_.drift();
    if (!measured) {
        return;
    }
    sample->monotonic_ns = *measured;
    sample->realtime_ns = system_.realtime_ns() - (arrived - *measured);
    ++facts_.samples;
    if (facts_.state != SensorState::streaming) {
        set_state(SensorState::streaming, "");
    }
    sink_(*sample);
}

/// Errors are ignored: if the camera stops, step() notices the silence.
void SensorStream::ping() {
    system_.send(handle_, sensor_ping);
    ping_at_ = system_.now() + ping_interval;
}

void SensorStream::close() {
    if (handle_ >= 0) {
        system_.close(handle_);
        handle_ = -1;
    }
}

void SensorStream::close_and_retry() {
    close();
    retry_at_ = system_.now() + retry_interval;
    if (facts_.state == SensorState::streaming) {
        set_state(SensorState::absent, "the sensors of " + camera_->label() + " have gone; they are looked for");
    }
}

}  // namespace disparityd::capture
