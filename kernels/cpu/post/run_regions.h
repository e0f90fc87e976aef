// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace disparityd::cpu {

/// Runs of pixels in the order of the image, and the regions that they are joined to. A region is a tree of runs whose
/// root is its first one.
///
/// Bands of rows may be filled side by side, each by an object of its own on the same memory; numbers of runs are the
/// same for all.
class RunRegions {
public:
    /// Of the memory that the constructor takes, aligned to 4.
    static std::size_t bytes(std::size_t max_runs) { return max_runs * (2 * sizeof(std::int32_t) + sizeof(Run)); }

    /// Runs are counted from `first`.
    RunRegions(std::byte* memory, std::size_t max_runs, int first = 0)
        : links_(reinterpret_cast<std::int32_t*>(memory)),
          votes_(links_ + max_runs),
          runs_(reinterpret_cast<Run*>(votes_ + max_runs)),
          first_(first),
          begun_(first),
          ended_(first) {}

    /// Begins and ends come in the same order, an end after its begin; several may be begun before the first ends.
    void begin(int x) { runs_[begun_++].begin = static_cast<std::uint16_t>(x); }
    void end(int x) {
        runs_[ended_].end = static_cast<std::uint16_t>(x);
        links_[ended_] = runs_[ended_].begin - x;
        ++ended_;
    }
    /// Of a run that has ended, before it is joined. Without a call the votes of its region mean nothing.
    void vote(int run, int votes) { votes_[run] = votes; }
    int begun() const { return begun_; }

    int begin_of(int run) const { return runs_[run].begin; }
    int end_of(int run) const { return runs_[run].end; }

    /// Adds the pixels of two regions together, and their votes where `with_votes`.
    void join(int a, int b, bool with_votes) {
        const int root_a = shorten_to_root(a);
        const int root_b = shorten_to_root(b);
        if (root_a != root_b) {
            const int root = std::min(root_a, root_b);
            const int other = std::max(root_a, root_b);
            links_[root] += links_[other];
            links_[other] = root;
            if (with_votes) {
                votes_[root] += votes_[other];
            }
        }
    }

    /// Links all runs of this object to their roots, when none has been joined to one of another object yet.
    void flatten() {
        for (int run = first_; run < begun_; ++run) {
            // In ascending order: the one linked to is a root, or is linked to one already.
            const std::int32_t link = links_[run];
            const int next = link < 0 ? run : link;
            links_[run] = links_[next] < 0 ? link : links_[next];
        }
    }

    /// The first run of the region of a run; writes nothing.
    int root_of(int run) const {
        while (links_[run] >= 0) {
            run = links_[run];
        }
        return run;
    }

    /// Of the region that begins with the run.
    int pixels(int root) const { return -links_[root]; }
    int votes(int root) const { return votes_[root]; }

private:
    struct Run {
        std::uint16_t begin;
        std::uint16_t end;
    };

    int shorten_to_root(int run) {
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
    std::int32_t* votes_;  // of a root: those of its region
    Run* runs_;
    int first_;
    int begun_;
    int ended_;
};

}  // namespace disparityd::cpu
