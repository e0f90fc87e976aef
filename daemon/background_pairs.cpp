// SPDX-License-Identifier: Apache-2.0
#include "daemon/background_pairs.h"

#include <algorithm>
#include <utility>

#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include "base/start_thread.h"
#include "daemon/ends_alone.h"

namespace disparityd::daemon {
namespace {

using std::chrono::steady_clock;

void copy(Plane<const std::uint8_t> plane, std::vector<std::uint8_t>& to) {
    for (int y = 0; y < plane.height; ++y) {
        std::copy_n(plane.row(y), plane.width, to.begin() + static_cast<std::ptrdiff_t>(y) * plane.width);
    }
}

}  // namespace

BackgroundPairs::BackgroundPairs(const char* name, int width, int height, std::chrono::nanoseconds interval, Look look)
    : name_(name),
      width_(width),
      height_(height),
      interval_(interval),
      look_(std::move(look)),
      left_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)),
      right_(left_.size()),
      thread_(base::start_thread([this] { run(); })) {}

BackgroundPairs::~BackgroundPairs() {
    stopping_.store(true);
    // A change of the stage wakes the thread, whatever it waits for.
    stage_.store(filled);
    stage_.notify_one();
    thread_.join();
}

void BackgroundPairs::give(const FrameView& frame) noexcept {
    copy(frame.left, left_);
    copy(frame.right, right_);
    int expected = wanted;
    if (stage_.compare_exchange_strong(expected, filled, std::memory_order_acq_rel)) {
        stage_.notify_one();
    }
}

void BackgroundPairs::run() {
    pthread_setname_np(pthread_self(), name_);
    // Not SCHED_IDLE: on a busy machine the thread would never run.
    constexpr int least_urgent = 19;
    setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), least_urgent);
    while (!stopping_.load()) {
        due_.store(steady_clock::now() + interval_, std::memory_order_relaxed);
        int before = busy;
        stage_.compare_exchange_strong(before, wanted, std::memory_order_acq_rel);
        stage_.wait(wanted, std::memory_order_acquire);
        if (stopping_.load()) {
            return;
        }
        stage_.store(busy, std::memory_order_relaxed);
        ends_alone(name_, [this] {
            look_({left_.data(), width_, height_, width_}, {right_.data(), width_, height_, width_});
        });
    }
}

}  // namespace disparityd::daemon
