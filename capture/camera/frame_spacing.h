// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace disparityd::capture {

/// Tells by their stamps how far apart the frames of a camera come, for drivers that tell no rate.
class FrameSpacing {
public:
    /// Takes the next frame; `number` counts those that were lost, too. Nobody knows how many were in a `gap`.
    void add(std::int64_t stamp_ns, std::uint64_t number, bool gap) {
        const std::int64_t whole = stamp_ns - stamp_ns_;
        const std::int64_t one = begun_ && number > number_ ? whole / static_cast<std::int64_t>(number - number_) : 0;
        // A driver that numbers no frames makes a gap of each.
        const bool longer = gap && ns_ > 0 && one > 2 * ns_;
        ns_ = one > 0 && !longer ? one : 0;
        begun_ = true;
        stamp_ns_ = stamp_ns;
        number_ = number;
    }

    /// Returns nanoseconds between the newest frame and the one before; 0: unknown.
    std::int64_t ns() const { return ns_; }

private:
    bool begun_ = false;
    std::int64_t stamp_ns_ = 0;
    std::uint64_t number_ = 0;
    std::int64_t ns_ = 0;
};

}  // namespace disparityd::capture
