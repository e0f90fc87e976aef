// SPDX-License-Identifier: Apache-2.0
#include "bindings/python/native/forked_pair_matcher.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <utility>

#include <unistd.h>

#include "base/memory_room.h"
#include "pipeline/worker_pool.h"

namespace disparityd::bindings {

struct ForkedPairMatcher::State {
    State(int width, int height, const MatchOptions& options, const std::string& back_end)
        : matcher(width, height, options, back_end) {}

    std::mutex mutex;
    PairMatcher matcher;
    std::optional<pipeline::WorkerPool> pool;  ///< none: the calling thread does everything
};

ForkedPairMatcher::ForkedPairMatcher(int width, int height, const MatchOptions& options, const std::string& back_end,
                                     int threads)
    : width_(width),
      height_(height),
      options_(options),
      back_end_(back_end),
      threads_(threads),
      process_(getpid()),
      state_(make()) {}

ForkedPairMatcher::~ForkedPairMatcher() {
    if (getpid() != process_) {
        static_cast<void>(state_.release());  // its threads are not here to be joined
    }
}

std::unique_ptr<ForkedPairMatcher::State> ForkedPairMatcher::make() const {
    const std::size_t before = large_memory_held();
    auto made = std::make_unique<State>(width_, height_, options_, back_end_);
    // Not pinned: several of these may share the cores.
    if (threads_ != 1) {
        made->pool.emplace(threads_, pipeline::Pinning::never);
    }
    // Only now is it known how much that is, and none of it has been written.
    base::check_memory_room(large_memory_held() - std::min(before, large_memory_held()), base::memory_room());
    return made;
}

void ForkedPairMatcher::prepare() {
    if (const int process = getpid(); process != process_) {
        auto made = make();  // may throw: then the next call tries it again
        static_cast<void>(state_.release());
        state_ = std::move(made);
        process_ = process;
    }
}

void ForkedPairMatcher::match(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right,
                              const PairResults& results) {
    const std::lock_guard lock(state_->mutex);
    if (!state_->pool) {
        Serial serial;
        state_->matcher.match(left, right, results, serial);
        return;
    }
    const pipeline::WorkerPool::ComputeSlot slot(*state_->pool);
    state_->matcher.match(left, right, results, *state_->pool);
}

std::string ForkedPairMatcher::trouble() const {
    return state_->matcher.trouble();
}

}  // namespace disparityd::bindings
