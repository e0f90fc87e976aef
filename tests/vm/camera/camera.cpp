// SPDX-License-Identifier: Apache-2.0
#include "tests/vm/camera/camera.h"

#include <stdexcept>

#include <sys/timerfd.h>

namespace simulated_camera {

Camera::Camera(const CameraOptions& options, Plug plug)
    : options_(options),
      plug_(std::move(plug)),
      feed_(options.frames_file, options.jpeg),
      timer_(::timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC)) {
    if (!timer_) {
        throw std::runtime_error("the system gives no timer");
    }
}

void Camera::plug_in() {
    if (!device_) {
        device_.emplace(options_, plug_(options_.link), feed_, faults_, counters_);
        if (options_.sensors && options_.model->sensor_product_id != 0) {
            sensors_.emplace(options_, plug_(Link::usb2));
        }
    }
}

void Camera::unplug() {
    device_.reset();
    sensors_.reset();
    faults_ = Faults();
    set_timer();
}

void Camera::become(const Model& model, std::uint32_t serial) {
    options_.model = &model;
    options_.serial = serial;
}

void Camera::thaw() {
    faults_.frozen = FrozenUntil::not_frozen;
    if (device_) {
        device_->stream().pump();
    }
}

std::string Camera::describe() const {
    return "plugged=" + std::to_string(device_ ? 1 : 0) + " streaming=" + std::to_string(timer_interval_ > 0 ? 1 : 0) +
           " sent=" + std::to_string(counters_.sent) + " late=" + std::to_string(counters_.late) +
           " number=" + std::to_string(counters_.number);
}

void Camera::handle_host() {
    if (!device_->handle_message()) {
        unplug();
        return;
    }
    set_timer();
}

void Camera::handle_timer() {
    std::uint64_t intervals = 0;
    if (::read(timer_.get(), &intervals, sizeof intervals) == sizeof intervals && device_) {
        device_->stream().tick(intervals);
    }
}

void Camera::set_timer() {
    const std::uint32_t interval = device_ && device_->stream().running() ? device_->interval() : 0;
    if (interval == timer_interval_) {
        return;
    }
    timer_interval_ = interval;
    itimerspec times{};
    times.it_interval.tv_sec = interval / 10'000'000;
    times.it_interval.tv_nsec = static_cast<long>(interval % 10'000'000) * 100;
    times.it_value = times.it_interval;
    ::timerfd_settime(timer_.get(), 0, &times, nullptr);
}

}  // namespace simulated_camera
