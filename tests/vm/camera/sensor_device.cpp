// SPDX-License-Identifier: Apache-2.0
#include "tests/vm/camera/sensor_device.h"

#include <algorithm>
#include <cerrno>
#include <stdexcept>
#include <string>

#include <sys/timerfd.h>
#include <time.h>
#include <unistd.h>

#include "tests/vm/camera/sensor_report.h"

namespace simulated_camera {

namespace {

// A real one sends four times as many; emulated machines have enough to do.
constexpr long report_interval_ns = 10'000'000;
constexpr std::int64_t longest_without_ping_ns = 6'000'000'000;

// Of the HID class (HID 1.11, 7.2).
constexpr std::uint8_t set_report_request = 9;
constexpr std::uint8_t set_idle_request = 10;

enum DescriptorType : std::uint8_t { device = 1, configuration = 2, string = 3, hid = 0x21, report = 0x22 };

constexpr std::uint8_t serial_string = 3;

// Vendor's page: input report 1 of 63 bytes, feature reports 0x21 and 0x32 of one.
const Bytes report_descriptor{0x06, 0x00, 0xff, 0x09, 0x01, 0xa1, 0x01, 0x15, 0x00, 0x26, 0xff, 0x00, 0x75,
                              0x08, 0x85, 0x01, 0x09, 0x02, 0x95, 0x3f, 0x81, 0x02, 0x85, 0x21, 0x09, 0x03,
                              0x95, 0x01, 0xb1, 0x02, 0x85, 0x32, 0x09, 0x04, 0x95, 0x01, 0xb1, 0x02, 0xc0};

Bytes hid_descriptor() {
    return {9, hid, 0x11, 0x01, 0, 1, report, static_cast<std::uint8_t>(report_descriptor.size()), 0};
}

Bytes configuration_descriptor() {
    Bytes bytes{9, configuration, 0, 0, 1, 1, 0, 0x80, 50, 9, 4, 0, 0, 1, 3, 0, 0, 0};
    append(bytes, hid_descriptor());
    append(bytes, Bytes{7, 5, 0x81, 3, 64, 0, 4});
    put_little_endian(bytes, 2, static_cast<std::uint32_t>(bytes.size()), 2);
    return bytes;
}

Bytes device_descriptor(const CameraOptions& camera) {
    Bytes bytes{18, device, 0x00, 0x02, 0, 0, 0, 64};
    append_little_endian(bytes, vendor_id, 2);
    append_little_endian(bytes, camera.model->sensor_product_id, 2);
    append_little_endian(bytes, 0x0308, 2);
    append(bytes, Bytes{0, 2, serial_string, 1});
    return bytes;
}

Bytes string_descriptor(const std::string& text) {
    Bytes bytes{static_cast<std::uint8_t>(2 + 2 * text.size()), string};
    for (const char c : text) {
        append_little_endian(bytes, static_cast<std::uint8_t>(c), 2);
    }
    return bytes;
}

std::int64_t monotonic_ns() {
    timespec now{};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * std::int64_t{1'000'000'000} + now.tv_nsec;
}

}  // namespace

SensorDevice::SensorDevice(const CameraOptions& camera, FileDescriptor socket)
    : camera_(camera),
      host_(std::move(socket), 0),
      timer_(::timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC)) {
    itimerspec times{};
    times.it_value.tv_nsec = report_interval_ns;
    times.it_interval.tv_nsec = report_interval_ns;
    if (!timer_ || ::timerfd_settime(timer_.get(), 0, &times, nullptr) != 0) {
        throw std::runtime_error("the system gives no timer");
    }
}

bool SensorDevice::handle_message() {
    auto message = host_.receive();
    if (!message) {
        return false;
    }
    if (const auto* withdrawal = std::get_if<Withdrawal>(&*message)) {
        const bool waited = std::erase(waiting_, withdrawal->submission) > 0;
        host_.complete_withdrawal(withdrawal->sequence, waited ? -ECONNRESET : 0);
        return true;
    }
    const Submission& submission = std::get<Submission>(*message);
    if (submission.endpoint != 0) {
        waiting_.push_back(submission.sequence);
        return true;
    }
    const ControlAnswer answer = control(submission.setup, submission.data);
    if (!answer) {
        host_.complete(submission.sequence, -EPIPE, {});
    } else if (submission.setup.to_host()) {
        const std::size_t length = std::min<std::size_t>(answer->size(), submission.setup.length);
        host_.complete(submission.sequence, 0, std::span(*answer).first(length));
    } else {
        host_.complete_taken(submission.sequence, submission.length);
    }
    return true;
}

void SensorDevice::handle_timer() {
    std::uint64_t intervals = 0;
    const bool fired = ::read(timer_.get(), &intervals, sizeof intervals) == sizeof intervals;
    const std::int64_t now = monotonic_ns();
    if (!fired || !on_ || now > pinged_ns_ + longest_without_ping_ns || waiting_.empty()) {
        return;
    }
    host_.complete(waiting_.front(), 0, sensor_report(number_++, now));
    waiting_.pop_front();
}

ControlAnswer SensorDevice::control(const SetupPacket& setup, std::span<const std::uint8_t> data) {
    if (setup.is_class()) {
        switch (setup.request) {
            case set_report_request: return set_report(data);
            case set_idle_request: return Bytes();
            default: return std::nullopt;
        }
    }
    switch (setup.request) {
        case get_descriptor: return find_descriptor(setup.value_high(), setup.value_low());
        case get_status: return Bytes{0, 0};
        case get_configuration: return Bytes{1};
        case get_interface: return Bytes{0};
        case clear_feature:
        case set_feature:
        case set_configuration:
        case set_interface: return Bytes();
        default: return std::nullopt;
    }
}

ControlAnswer SensorDevice::find_descriptor(std::uint8_t type, std::uint8_t index) const {
    switch (type) {
        case device: return device_descriptor(camera_);
        case configuration: return configuration_descriptor();
        case hid: return hid_descriptor();
        case report: return report_descriptor;
        case string:
            if (index == 0) {
                return Bytes{4, string, 0x09, 0x04};
            }
            return string_descriptor(index == serial_string ? std::to_string(camera_.serial) : "simulated sensors");
        default: return std::nullopt;
    }
}

ControlAnswer SensorDevice::set_report(std::span<const std::uint8_t> report) {
    if (report.size() != 2) {
        return std::nullopt;
    }
    if (report[0] == 0x32) {
        on_ = report[1] == 1;
    } else if (report[0] != 0x21 || report[1] != 0xf2) {
        return std::nullopt;
    }
    pinged_ns_ = monotonic_ns();
    return Bytes();
}

}  // namespace simulated_camera
