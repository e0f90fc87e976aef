// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/sweep_turns.h"

#include <bit>

namespace disparityd::cpu {

namespace {

// What a worker in a sweep adds to more_down_.
constexpr int weight(int sweep) {
    return sweep == 0 ? 1 : -1;
}

}  // namespace

SweepTurns::SweepTurns(const Groups& groups) : groups_(groups) {}

int SweepTurns::groups() const {
    return groups_[0][0] + groups_[0][1] + groups_[1][0] + groups_[1][1];
}

SweepTurns::Worker SweepTurns::join() {
    Worker worker;
    std::uint64_t seats = seats_.load(std::memory_order_relaxed);
    do {
        worker.seat = std::countr_one(seats);
    } while (!seats_.compare_exchange_weak(seats, seats | std::uint64_t{1} << worker.seat, std::memory_order_acquire,
                                           std::memory_order_relaxed));
    int more_down = more_down_.load(std::memory_order_relaxed);
    do {
        worker.sweep = more_down > 0 ? 1 : 0;
    } while (!more_down_.compare_exchange_weak(more_down, more_down + weight(worker.sweep)));
    return worker;
}

void SweepTurns::leave(const Worker& worker) {
    more_down_.fetch_sub(weight(worker.sweep));
    // What this worker wrote in its seat's memory is over before the next one sits down.
    seats_.fetch_and(~(std::uint64_t{1} << worker.seat), std::memory_order_release);
}

bool SweepTurns::take(Worker& worker, RowGroup& group) {
    move_to_emptier(worker);
    for (const int part : {0, 1}) {
        if (take(part, worker.sweep, group)) {
            return true;
        }
        if (take(part, 1 - worker.sweep, group)) {
            move(worker);
            return true;
        }
    }
    return false;
}

bool SweepTurns::take(int part, int sweep, RowGroup& group) {
    const auto s = static_cast<std::size_t>(sweep);
    const auto p = static_cast<std::size_t>(part);
    std::atomic<int>& taken = taken_[s][p];
    if (taken.load(std::memory_order_relaxed) >= groups_[s][p]) {
        return false;
    }
    const int index = taken.fetch_add(1, std::memory_order_relaxed);
    group = {sweep, part, index + (part == 0 ? 0 : groups_[s][0])};
    return index < groups_[s][p];
}

void SweepTurns::move_to_emptier(Worker& worker) {
    int more_down = more_down_.load(std::memory_order_relaxed);
    while (weight(worker.sweep) * more_down > 1) {
        if (more_down_.compare_exchange_weak(more_down, more_down - 2 * weight(worker.sweep))) {
            worker.sweep = 1 - worker.sweep;
            return;
        }
    }
}

void SweepTurns::move(Worker& worker) {
    more_down_.fetch_sub(2 * weight(worker.sweep));
    worker.sweep = 1 - worker.sweep;
}

}  // namespace disparityd::cpu
