// SPDX-License-Identifier: Apache-2.0
#include "daemon/shared_memory_publisher.h"

#include <array>
#include <chrono>
#include <span>

#include "base/start_thread.h"
#include "daemon/log.h"

namespace disparityd::daemon {
namespace {

/// The contract demands two beats a second; four leave a margin for a busy machine.
constexpr std::chrono::milliseconds heartbeat_interval{250};

/// So many readers are woken by the thread that publishes, which takes some 20 us each: so none of them waits for a
/// thread that is busy elsewhere. Another thread wakes the rest.
constexpr int woken_at_once = 32;

/// A reader that does not lock the memory and waits at least so often counts as one all the time.
constexpr std::chrono::seconds longest_work_of_reader{2};

static_assert(product_count <= proto::shm_max_planes, "all products may be served at the same time");

proto::ShmLayout to_shm(const StreamLayout& layout) {
    proto::ShmLayout shm;
    shm.width = layout.geometry.width;
    shm.height = layout.geometry.height;
    for (const v1::Product product : layout.products) {
        const ProductShape shape = product_shape(layout, product);
        const auto number = static_cast<std::uint32_t>(product);
        shm.planes.push_back(is_record(product) ? proto::ShmLayout::Plane{number, 0, shape.bytes()}
                                                : proto::ShmLayout::Plane{number, shape.bytes_per_pixel, 0});
    }
    return shm;
}

}  // namespace

SharedMemoryPublisher::SharedMemoryPublisher(const std::string& name, const StreamLayout& layout, std::uint32_t slots)
    : layout_(layout), slots_(slots), writer_(name, to_shm(layout), slots) {
    if (!writer_.note().empty()) {
        log_warning(writer_.note());
    }
    thread_ = base::start_thread([this] { keep_alive(); });
}

SharedMemoryPublisher::~SharedMemoryPublisher() {
    {
        const std::lock_guard lock(mutex_);
        stopping_ = true;
    }
    changed_.notify_one();
    thread_.join();
}

void SharedMemoryPublisher::publish(const PublishedFrame& frame, bool outdated) {
    std::array<proto::PlaneSource, product_count> planes;
    for (std::size_t i = 0; i < layout_.products.size(); ++i) {
        const auto& plane = frame.planes[i];
        planes[i] = {static_cast<std::uint32_t>(layout_.products[i]), plane.data, static_cast<std::size_t>(plane.width),
                     static_cast<std::size_t>(plane.stride)};
    }
    writer_.publish(frame.info, std::span(planes).first(layout_.products.size()),
                    std::chrono::nanoseconds(frame.published.time_since_epoch()).count(), outdated);
    if (wake(woken_at_once) == woken_at_once) {
        {
            const std::lock_guard lock(mutex_);
            more_to_wake_ = true;
        }
        changed_.notify_one();
    }
}

int SharedMemoryPublisher::wake(int most) {
    const int woken = writer_.wake(most);
    if (woken > 0) {
        reader_waited_.store(std::chrono::steady_clock::now(), std::memory_order_relaxed);
    }
    return woken;
}

bool SharedMemoryPublisher::has_reader() {
    const auto waited = reader_waited_.load(std::memory_order_relaxed);
    return writer_.has_reader() || std::chrono::steady_clock::now() < waited + longest_work_of_reader || wake(1) > 0;
}

void SharedMemoryPublisher::relayout(const StreamLayout& layout, std::uint32_t slots) {
    const bool same = slots == slots_ && layout.products == layout_.products &&
                      layout.record_bytes == layout_.record_bytes && layout.geometry.width == layout_.geometry.width &&
                      layout.geometry.height == layout_.geometry.height;
    if (!same) {
        writer_.relayout(to_shm(layout), slots);
    }
    layout_ = layout;
    slots_ = slots;
}

void SharedMemoryPublisher::keep_alive() {
    std::unique_lock lock(mutex_);
    while (!stopping_) {
        changed_.wait_for(lock, heartbeat_interval, [this] { return more_to_wake_ || stopping_; });
        const bool wake = more_to_wake_;
        more_to_wake_ = false;
        lock.unlock();
        if (wake) {
            writer_.wake();
        }
        writer_.heartbeat();
        lock.lock();
    }
}

}  // namespace disparityd::daemon
