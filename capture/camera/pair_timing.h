// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "capture/source_condition.h"

namespace disparityd::capture {

/// Measures how far apart the stamps of two eyes' frames are: the median of the pairs of some seconds, and how it
/// changes from then to then. One thread uses an object. It allocates nothing.
class PairTiming {
public:
    /// `interval_ns` is the time from one pair to the next.
    explicit PairTiming(std::int64_t interval_ns) : interval_ns_(interval_ns) {}

    /// Takes a pair. Returns whether newest() has become another one.
    bool add(std::int64_t left_ns, std::int64_t right_ns);

    /// Begins anew: a stream has.
    void restart();

    /// Returns what was measured last; nothing before the second window has ended.
    const std::optional<EyesApart>& newest() const { return newest_; }

    /// Whether the frames are apart by more than a tenth of the interval, as those of cameras are that run free. It
    /// stays until they are nearer than a twentieth.
    bool unsynchronised() const { return unsynchronised_; }

    static constexpr std::int64_t window_ns = 2'500'000'000;

private:
    struct Window {
        std::int64_t centre_ns = 0;
        std::int64_t median_ns = 0;
    };

    void end_window(const Window& window);

    const std::int64_t interval_ns_;
    std::array<std::int64_t, 512> apart_{};  ///< of the window that has begun; it ends when this is full
    std::size_t count_ = 0;
    std::int64_t begun_ns_ = 0;
    std::optional<Window> anchor_;  ///< the drift is measured from here
    std::optional<Window> last_;
    std::optional<EyesApart> newest_;
    bool unsynchronised_ = false;
};

}  // namespace disparityd::capture
