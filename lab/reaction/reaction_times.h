// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

namespace disparityd::reaction {

/// A frame as a client saw it.
struct SeenFrame {
    std::uint64_t sequence = 0;    ///< counts the frames of the source; a round begins at 0
    std::int64_t received_ns = 0;  ///< on any clock that goes on evenly
    std::int64_t age_ns = 0;       ///< from capture to publishing
    bool shown = false;            ///< its scan shows the pole of its round
};

/// Finds out, from the frames that a client saw, how long after its first frame's capture each pole was shown. Frames
/// that were dropped need not be seen: the source captures one in each period, so that the frames of a round say when
/// every other one was captured.
class ReactionTimes {
public:
    /// A round has frames without the pole first.
    ReactionTimes(std::int64_t period_ns, int without, int with);

    /// Takes the next frame, in order.
    void add(const SeenFrame& frame);

    /// What rounds that are over had; the first and the last one, which are not whole, do not count.
    struct Result {
        std::vector<std::int64_t> reactions_ns;
        int appearances = 0;
        int never_shown = 0;
        int shown_before = 0;  ///< rounds whose scans showed something there before the pole came
    };
    const Result& result() const { return result_; }

private:
    void end_round();

    std::int64_t period_ns_;
    std::uint64_t without_;
    std::uint64_t frames_;
    Result result_;
    std::uint64_t round_ = 0;
    int rounds_begun_ = 0;
    std::int64_t begun_ns_ = 0;  ///< when the round's first frame was captured, as the quickest frame says
    std::int64_t shown_ns_ = 0;
    bool shown_ = false;
    bool shown_before_ = false;
};

}  // namespace disparityd::reaction
