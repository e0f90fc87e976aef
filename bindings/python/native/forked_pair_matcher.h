// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "kernels/pair_matcher.h"

namespace disparityd::bindings {

/// A matcher with threads of its own, which goes on in a process that was forked off, as Python's multiprocessing does:
/// threads do not come along, so the child makes all of it anew at its first call.
class ForkedPairMatcher {
public:
    /// `threads`: 0 = as many as the process can keep running, 1 = the caller's alone. Throws as PairMatcher does.
    ForkedPairMatcher(int width, int height, const MatchOptions& options, const std::string& back_end, int threads);
    ~ForkedPairMatcher();
    ForkedPairMatcher(const ForkedPairMatcher&) = delete;
    ForkedPairMatcher& operator=(const ForkedPairMatcher&) = delete;

    /// To be called by one thread at a time, before a call of the others: makes all anew in a child process.
    void prepare();

    /// As PairMatcher's. Any thread; while one matches, others wait.
    void match(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right, const PairResults& results);

    /// One line on what went wrong and was made good; empty as long as all is well.
    std::string trouble() const;

    const MatchOptions& options() const { return options_; }

private:
    struct State;
    std::unique_ptr<State> make() const;

    const int width_;
    const int height_;
    const MatchOptions options_;
    const std::string back_end_;
    const int threads_;
    int process_;
    std::unique_ptr<State> state_;
};

}  // namespace disparityd::bindings
