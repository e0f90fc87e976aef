// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <pthread.h>

namespace disparityd::pipeline {

/// Lends a core to each thread that computes, so that two never share a core while another one is free. A thread for
/// which there is none gets `none`; where the system does not allow pinning, all do.
///
/// take(), pass_on() and give_back() allocate nothing. Not thread-safe: the worker pool calls under its lock.
class CoreAllocator {
public:
    static constexpr int none = -1;

    /// For `workers` threads at a time; asks the system whether threads may be pinned. `wanted` false: they are not.
    CoreAllocator(int workers, bool wanted);

    /// Returns the cores that could be added: those that the process may use, the best ones first; none where pinning
    /// is off.
    const std::vector<int>& allowed() const { return allowed_; }
    /// Returns how many more cores the workers could use.
    int missing() const;

    /// Lends this core, too, from now on.
    void add(int number);
    /// Lends the core no more. A thread that has it keeps it until it gives it back.
    void withdraw(int number);
    /// Says for people why cores are missing.
    void explain(std::string why) { why_missing_ = std::move(why); }

    /// Takes a free core: `preferred` when it is free, else the first that is, `avoided` only when there is no other.
    int take(int preferred, int avoided);
    void give_back(int number);
    /// Returns the core that the next thread has in place of the one that gives this one back; it may be `none`, and
    /// so may what comes back.
    int pass_on(int number);
    bool is_free(int number) const;

    /// Lends no core from now on: the system has refused to pin a thread, `error` is its errno.
    void disable(int error);

    bool pinning_enabled() const { return problem_.empty(); }
    /// Returns whether there is a core for each worker; also while nobody has looked for some.
    bool is_complete() const { return pinning_enabled() && (missing() == 0 || why_missing_.empty()); }
    /// Returns "pinned, each to one of cores 0-3, 6"; "pinned to cores 0-1, but for 2 of 4: " or "not pinned to cores:
    /// " and why.
    std::string text() const;

private:
    struct Core {
        int number;
        bool taken = false;
        bool withdrawn = false;
    };
    Core* find(int number);

    const int workers_;
    std::vector<int> allowed_;
    std::vector<Core> cores_;
    std::string problem_;  ///< why no thread is pinned
    std::string why_missing_;
};

/// Lets a thread run on this core only. Returns 0, or the errno of the refusal. Any thread may call it.
int pin_to_core(pthread_t thread, int core);

}  // namespace disparityd::pipeline
