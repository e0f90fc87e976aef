// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/sgm/sweep_progress.h"

#include "hwy/cache_control.h"
#include "kernels/spin_until.h"

namespace disparityd::cpu {

namespace {

template <class Reached>
void wait_until(const std::atomic<int>& value, Reached reached) {
    // A row takes about ten microseconds; spin_until() spins for 50.
    if (spin_until([&] { return reached(value.load(std::memory_order_acquire)); })) {
        return;
    }
    for (int seen = value.load(std::memory_order_acquire); !reached(seen);
         seen = value.load(std::memory_order_acquire)) {
        value.wait(seen, std::memory_order_acquire);
    }
}

}  // namespace

// Whether somebody sleeps may be looked up before the new value is visible; who fell asleep in between is woken by what
// comes later. Ordering the two would hold up the worker until all its streamed stores have arrived.
void SweepProgress::reached(const RowGroup& group, int position) {
    std::atomic<int>& value = place(group.sweep, group.index);
    value.store(value_of(group.index, position), std::memory_order_release);
    value.notify_all();
}

void SweepProgress::completed(const RowGroup& group) {
    std::atomic<int>& value = place(group.sweep, group.index);
    value.store(value_of(group.index, positions - 1), std::memory_order_seq_cst);
    value.notify_all();
}

void SweepProgress::wait_for_previous_group(const RowGroup& group, int position) {
    if (group.index > 0) {
        const int wanted = value_of(group.index - 1, position);
        wait_until(place(group.sweep, group.index - 1), [=](int value) { return value >= wanted; });
    }
}

void SweepProgress::sums_stored(int groups) {
    // Streamed stores are not ordered by what follows.
    hwy::FlushStream();
    if (groups_without_sums_.fetch_sub(groups) == groups) {
        groups_without_sums_.notify_all();
    }
}

void SweepProgress::wait_for_sums() const {
    wait_until(groups_without_sums_, [](int groups) { return groups == 0; });
}

}  // namespace disparityd::cpu
