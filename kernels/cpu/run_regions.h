// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace disparityd::cpu {

/// Runs of pixels in the order of the image, and the regions that they are joined to. A region is a tree of runs whose
/// root is its first one.
class RunRegions {
public:
    /// Of the memory that the constructor takes, aligned to 4.
    static std::size_t bytes(std::size_t most_runs) { return most_runs * (sizeof(std::int32_t) + sizeof(Run)); }

    RunRegions(std::byte* memory, std::size_t most_runs)
        : links_(reinterpret_cast<std::int32_t*>(memory)), runs_(reinterpret_cast<Run*>(links_ + most_runs)) {}

    /// Begins and ends come in the same order, an end after its begin; several may be begun before the first ends.
    void begin(int x) { runs_[begun_++].begin = static_cast<std::uint16_t>(x); }
    void end(int x) {
        runs_[ended_].end = static_cast<std::uint16_t>(x);
        links_[ended_] = runs_[ended_].begin - x;
        ++ended_;
    }
    int begun() const { return begun_; }

    int begin_of(int run) const { return runs_[run].begin; }
    int end_of(int run) const { return runs_[run].end; }

    void join(int a, int b) {
        const int root_a = root_of(a);
        const int root_b = root_of(b);
        if (root_a != root_b) {
            const int root = std::min(root_a, root_b);
            const int other = std::max(root_a, root_b);
            links_[root] += links_[other];
            links_[other] = root;
        }
    }

    /// Pixels in the region of `run`. To be asked for all runs in ascending order, when all are joined: then each finds
    /// the one that it is linked to next to the root.
    int size_of_region(int run) {
        const std::int32_t link = links_[run];
        const int next = link < 0 ? run : link;
        const int root = links_[next] < 0 ? next : links_[next];
        links_[run] = link < 0 ? link : root;
        return -links_[root];
    }

private:
    struct Run {
        std::uint16_t begin;
        std::uint16_t end;
    };

    int root_of(int run) {
        while (links_[run] >= 0) {
            const std::int32_t next = links_[run];
            if (links_[next] >= 0) {
                links_[run] = links_[next];  // half as far for who comes next
            }
            run = next;
        }
        return run;
    }

    std::int32_t* links_;  // an earlier run of the region; of a root, minus the pixels of the region
    Run* runs_;
    int begun_ = 0;
    int ended_ = 0;
};

}  // namespace disparityd::cpu
