// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <pthread.h>

namespace disparityd::pipeline {

/// Lends a core to each thread that computes, so that two never share a core while another one is free. Where the
/// system does not allow pinning, every core is `none`.
///
/// take() and give_back() allocate nothing. Not thread-safe: the worker pool calls under its lock.
class CoreAllocator {
public:
    static constexpr int none = -1;

    /// For `workers` threads at a time; asks the system whether threads may be pinned. `wanted` false: they are not.
    CoreAllocator(int workers, bool wanted);

    /// Takes a free core: `preferred` when it is free, else the first that is, `avoided` only when there is no other.
    int take(int preferred, int avoided);
    void give_back(int number);
    bool is_free(int number) const;

    /// Lends no core from now on: the system has refused to pin a thread, `error` is its errno.
    void disable(int error);

    bool pinning_enabled() const { return problem_.empty(); }
    /// Returns "pinned, each to one of cores 0-3, 6", or "not pinned to cores: " and why.
    std::string text() const;

private:
    struct Core {
        int number;
        bool taken = false;
    };
    std::vector<Core> cores_;
    std::string problem_;  ///< why no thread is pinned
};

/// Lets a thread run on this core only. Returns 0, or the errno of the refusal. Any thread may call it.
int pin_to_core(pthread_t thread, int core);

}  // namespace disparityd::pipeline
