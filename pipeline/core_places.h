// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <pthread.h>

namespace disparityd::pipeline {

/// Cores lent to threads while they work, each to one thread at a time, so that two never share a core while another
/// one is free. Where threads may not be bound, every core is `none` and nothing is done.
///
/// take() and give_back() allocate nothing. Not thread-safe: the worker pool calls under its lock.
class CorePlaces {
public:
    static constexpr int none = -1;

    /// For `workers` threads at a time; asks the system whether threads may be bound. `wanted` false: they are not.
    CorePlaces(int workers, bool wanted);

    /// A free core: `preferred` when it is free, else the first that is, `avoided` only when there is no other.
    int take(int preferred, int avoided);
    void give_back(int core);
    bool is_free(int core) const;

    /// From now on no core is handed out: the system has refused to bind a thread, `error` is its errno.
    void refused(int error);

    bool bound() const { return problem_.empty(); }
    /// "pinned, each to one of cores 0-3, 6", or "not pinned to cores: " and why.
    std::string text() const;

private:
    struct Place {
        int core;
        bool taken = false;
    };
    std::vector<Place> places_;
    std::string problem_;
};

/// Lets a thread run on this core only; 0, or the errno of the system's refusal. Any thread may call it.
int bind_to_core(pthread_t thread, int core);

}  // namespace disparityd::pipeline
