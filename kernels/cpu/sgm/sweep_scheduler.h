// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace disparityd::cpu {

/// A few rows of a sweep that are worked on side by side.
struct RowGroup {
    int sweep = 0;  ///< 0 downwards, 1 upwards
    int part = 0;   ///< 0 stores sums, 1 finds winners
    int index = 0;  ///< counted over both parts, in the direction of the sweep
};

/// Who works on which rows of a frame: any number of workers claim groups, each sweep's in order, the first part of
/// both sweeps before the second of either. So everything that a group depends on has been claimed earlier, by a worker
/// that is at work on it: waiting for it ends, however many workers there really are.
///
/// Workers spread evenly over the sweeps and stay in one while that is so: what the previous row left is in their
/// cache. All functions may be called by any thread at any time; none of them waits.
class SweepScheduler {
public:
    static constexpr int max_workers = 64;

    /// groups[sweep][part]
    using Groups = std::array<std::array<int, 2>, 2>;

    explicit SweepScheduler(const Groups& groups);

    /// Of both sweeps and parts.
    int groups() const;

    /// One worker, from join() to leave().
    struct Worker {
        int slot = 0;  ///< 0 .. max_workers - 1, held by nobody else, the lowest that is free
        int sweep = 0;
    };

    /// There must not be more than max_workers at a time.
    Worker join();

    /// Claims the next group; false when all are claimed.
    bool claim(Worker& worker, RowGroup& group);

    void leave(const Worker& worker);

private:
    bool claim(int part, int sweep, RowGroup& group);
    void move_to_emptier(Worker& worker);
    void move(Worker& worker);

    Groups groups_;
    alignas(64) std::array<std::array<std::atomic<int>, 2>, 2> claimed_{};  // [sweep][part]
    alignas(64) std::atomic<int> more_down_{0};                             // workers in sweep 0 less those in sweep 1
    std::atomic<std::uint64_t> slots_{0};
};

}  // namespace disparityd::cpu
