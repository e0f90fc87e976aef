// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/sgm/sweep_scheduler.h"

#include <bit>

namespace disparityd::cpu {

namespace {

// What a worker in a sweep adds to more_down_.
constexpr int weight(int sweep) {
    return sweep == 0 ? 1 : -1;
}

}  // namespace

SweepScheduler::SweepScheduler(const Groups& groups) : groups_(groups) {}

int SweepScheduler::groups() const {
    return groups_[0][0] + groups_[0][1] + groups_[1][0] + groups_[1][1];
}

SweepScheduler::Worker SweepScheduler::join() {
    Worker worker;
    std::uint64_t slots = slots_.load(std::memory_order_relaxed);
    do {
        worker.slot = std::countr_one(slots);
    } while (!slots_.compare_exchange_weak(slots, slots | std::uint64_t{1} << worker.slot, std::memory_order_acquire,
                                           std::memory_order_relaxed));
    int more_down = more_down_.load(std::memory_order_relaxed);
    do {
        worker.sweep = more_down > 0 ? 1 : 0;
    } while (!more_down_.compare_exchange_weak(more_down, more_down + weight(worker.sweep)));
    return worker;
}

void SweepScheduler::leave(const Worker& worker) {
    more_down_.fetch_sub(weight(worker.sweep));
    // Releases what this worker wrote to the scratch of its slot to the next one that gets the slot.
    slots_.fetch_and(~(std::uint64_t{1} << worker.slot), std::memory_order_release);
}

bool SweepScheduler::claim(Worker& worker, RowGroup& group) {
    move_to_emptier(worker);
    for (const int part : {0, 1}) {
        if (claim(part, worker.sweep, group)) {
            return true;
        }
        if (claim(part, 1 - worker.sweep, group)) {
            move(worker);
            return true;
        }
    }
    return false;
}

bool SweepScheduler::claim(int part, int sweep, RowGroup& group) {
    const auto s = static_cast<std::size_t>(sweep);
    const auto p = static_cast<std::size_t>(part);
    std::atomic<int>& claimed = claimed_[s][p];
    if (claimed.load(std::memory_order_relaxed) >= groups_[s][p]) {
        return false;
    }
    const int index = claimed.fetch_add(1, std::memory_order_relaxed);
    group = {sweep, part, index + (part == 0 ? 0 : groups_[s][0])};
    return index < groups_[s][p];
}

void SweepScheduler::move_to_emptier(Worker& worker) {
    int more_down = more_down_.load(std::memory_order_relaxed);
    while (weight(worker.sweep) * more_down > 1) {
        if (more_down_.compare_exchange_weak(more_down, more_down - 2 * weight(worker.sweep))) {
            worker.sweep = 1 - worker.sweep;
            return;
        }
    }
}

void SweepScheduler::move(Worker& worker) {
    more_down_.fetch_sub(2 * weight(worker.sweep));
    worker.sweep = 1 - worker.sweep;
}

}  // namespace disparityd::cpu
