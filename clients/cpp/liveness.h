// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

namespace disparity {

/// Tells when a daemon that says nothing is asked whether it is there, and when it is not. Is of one connection. All
/// times are in ns, and the caller brings them; heard_ns: when the last bytes were read. The Python client does the
/// same.
class Liveness {
public:
    static constexpr std::int64_t second = 1'000'000'000;
    /// The clocks are compared this often, by the same question, while frames come.
    static constexpr std::int64_t clock_interval = second;
    /// A daemon that has said nothing for so long, and for some intervals, is asked whether it is there.
    static constexpr std::int64_t least_silence = second / 2;
    static constexpr std::int64_t silent_intervals = 3;
    static constexpr std::int64_t longest_interval = 3600 * second;
    /// It must answer within this time.
    static constexpr std::int64_t answer_time = second;

    /// Returns whether a Ping is to be sent now, and counts it as sent. interval_ns: of what is expected.
    bool asks(std::int64_t now_ns, std::int64_t heard_ns, std::int64_t interval_ns) {
        if (asked_ns_ > heard_ns) {
            return false;  // it has been asked
        }
        const std::int64_t silence = silent_intervals * std::min(interval_ns, longest_interval);
        const bool silent = now_ns - heard_ns >= std::max(least_silence, silence);
        if (!silent && now_ns - asked_ns_ < clock_interval) {
            return false;
        }
        asked_ns_ = now_ns;
        return true;
    }

    /// Returns whether a Ping has waited for its answer too long.
    bool is_gone(std::int64_t now_ns, std::int64_t heard_ns) const {
        return asked_ns_ > heard_ns && now_ns - asked_ns_ > answer_time;
    }

    /// Returns when the last Ping was sent; 0 = never.
    std::int64_t asked_ns() const { return asked_ns_; }

private:
    std::int64_t asked_ns_ = 0;
};

}  // namespace disparity
