// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace disparity {

/// Returns the time within what every difference of two times fits in: a daemon may send anything.
constexpr std::int64_t sane_ns(std::int64_t ns) {
    constexpr std::int64_t most = std::int64_t{1} << 60U;
    return ns < -most ? -most : ns > most ? most : ns;
}

/// Bounds how far the daemon's CLOCK_MONOTONIC is ahead of this program's, from questions that the daemon has answered
/// with its clock. Times in ns. One thread.
class DaemonClock {
public:
    /// The daemon's clock showed `daemon_ns` between two instants of this program's clock.
    void add(std::int64_t before_ns, std::int64_t daemon_ns, std::int64_t after_ns);

    /// Forgets everything: another daemon answers from now on.
    void forget() { count_ = 0; }

    bool known() const { return count_ > 0; }

    /// Returns what the daemon's clock shows at most when this program's shows `now_ns`: an age that is counted up to
    /// it is never too small. Where the bounds allow that both have the same clock, as on one machine, it is that
    /// clock. Only while known.
    std::int64_t latest(std::int64_t now_ns) const;

    /// Returns the shortest time that an answer took, there and back. Only while known.
    std::int64_t round_trip() const;

private:
    struct Answer {
        std::int64_t at_ns;
        std::int64_t least_ns;  ///< the daemon's clock is ahead by at least this
        std::int64_t most_ns;
    };

    std::array<Answer, 16> answers_{};  ///< a ring of the newest
    std::size_t count_ = 0;             ///< of all since forget()
};

}  // namespace disparity
