// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace disparityd::test {

/// How long a reader waits for a frame before it says that the daemon hangs: far longer than a busy machine needs.
inline constexpr std::chrono::seconds longest_wait{60};

/// What a reader keeps of each frame.
struct SeenFrame {
    std::uint64_t publish_index = 0;
    std::uint64_t sequence = 0;
    std::uint64_t dropped_before = 0;
    std::uint64_t skipped = 0;  ///< since the frame before, as the reader was told
    std::int64_t age_ns = 0;    ///< when it was read
    bool discontinuity = false;
};

/// Adds up what a reader saw, and refuses frames that cannot follow the one before.
class ReaderAccount {
public:
    /// Throws std::logic_error with one line when the frame contradicts those before.
    void add(const SeenFrame& frame);

    /// A request or subscription that the daemon refused.
    void add_refusal(const std::string& why) { refusals_.push_back(why); }

    std::uint64_t frames() const { return frames_; }
    std::uint64_t skipped() const { return skipped_; }

    /// Returns one line of JSON.
    std::string to_json() const;

private:
    std::uint64_t frames_ = 0;
    std::uint64_t skipped_ = 0;
    std::uint64_t first_ = 0;
    SeenFrame last_;
    std::vector<float> ages_ms_;
    std::vector<std::string> refusals_;
};

/// Returns whether the driver of the test has asked this program to end: its standard input has ended.
bool asked_to_end();

}  // namespace disparityd::test
