// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>

#include "kernels/cpu/sgm/sweep_scheduler.h"

namespace disparityd::cpu {

/// How far the groups of rows of one frame have come. A worker says how far its group is, and waits for the
/// previous one: awake at first (spin_until.h), then asleep. What a worker wrote before it said so is visible to
/// who waited for it, streamed stores included once sums_stored() has been called.
class SweepProgress {
public:
    /// `groups_with_sums`: groups of part 0, of both sweeps.
    explicit SweepProgress(int groups_with_sums) : groups_without_sums_(groups_with_sums) {}

    /// The group is done up to this position (not included). May be seen late by who sleeps: completed() may not.
    void reached(const RowGroup& group, int position);

    /// The group is done, all of it.
    void completed(const RowGroup& group);

    /// Waits until the previous group of the sweep is done up to this position.
    void wait_for_previous_group(const RowGroup& group, int position);

    /// So many groups of part 0 are complete, their volumes too.
    void sums_stored(int groups);

    /// All of them are.
    bool all_sums_are_stored() const { return groups_without_sums_.load(std::memory_order_acquire) == 0; }
    void wait_for_sums() const;

private:
    // Position within a group and the number of the group in one, so that a place can be used again: by the time that a
    // group takes the place of another, that one is complete.
    static constexpr int positions = 1 << 14;
    static int value_of(int index, int position) { return (index + 1) * positions + position; }

    struct alignas(64) Place {
        std::atomic<int> value{0};
    };

    std::atomic<int>& place(int sweep, int index) {
        return places_[static_cast<std::size_t>(sweep)][static_cast<std::size_t>(index % SweepScheduler::max_workers)]
            .value;
    }

    std::array<std::array<Place, SweepScheduler::max_workers>, 2> places_;
    alignas(64) std::atomic<int> groups_without_sums_;
};

}  // namespace disparityd::cpu
