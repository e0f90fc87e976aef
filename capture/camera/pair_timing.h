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

    enum class Synchronised : unsigned char {
        unknown,  ///< near each other, as those of cameras that run free are from time to time, too
        yes,      ///< a trigger holds them together: no drift for evidence_ns
        no,       ///< apart by more than a tenth of the interval
    };
    /// Says what the frames show of the cameras. `no` stays until there is evidence that they are, at less than a
    /// twentieth of the interval.
    Synchronised synchronised() const { return synchronised_; }

    static constexpr std::int64_t window_ns = 2'500'000'000;

    /// Frames of cameras with clocks of their own move by more than most_drift. In this time that is 0.6 ms, more than
    /// a median of stamps on the USB is off.
    static constexpr std::int64_t evidence_ns = 300'000'000'000;
    static constexpr double most_drift = 2e-6;

private:
    struct Window {
        std::int64_t centre_ns = 0;
        std::int64_t median_ns = 0;
    };

    void end_window(const Window& window);
    void judge(const Window& window);

    const std::int64_t interval_ns_;
    std::array<std::int64_t, 512> apart_{};  ///< of the window that has begun; it ends when this is full
    std::size_t count_ = 0;
    std::int64_t begun_ns_ = 0;
    std::optional<Window> anchor_;  ///< the drift is measured from here
    std::optional<Window> last_;
    std::optional<EyesApart> newest_;
    std::optional<Window> near_;  ///< frames have been near each other since
    Synchronised synchronised_ = Synchronised::unknown;
};

}  // namespace disparityd::capture
