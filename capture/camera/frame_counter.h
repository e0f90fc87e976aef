// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace disparityd::capture {

/// Turns a driver's 32-bit frame numbers, which wrap and begin again with every start of the stream, into one that
/// only grows, and counts what was lost between.
class FrameCounter {
public:
    struct Place {
        std::uint64_t sequence = 0;
        std::uint32_t lost = 0;      ///< frames known to be lost since the one before
        bool discontinuity = false;  ///< nobody knows how many were lost
    };

    /// Says that the driver counts anew from the next frame on.
    void restarted() { restarted_ = true; }

    Place place(std::uint32_t driver_sequence) {
        const std::uint32_t step = driver_sequence - last_;
        last_ = driver_sequence;
        // A number that goes back is a driver that has started again by itself.
        constexpr std::uint32_t backwards = 1U << 31U;
        Place place;
        place.discontinuity = restarted_ || step == 0 || step >= backwards;
        place.lost = place.discontinuity ? 0 : step - 1;
        next_ += place.lost;
        place.sequence = next_++;
        place.discontinuity = place.discontinuity && place.sequence > 0;
        restarted_ = false;
        return place;
    }

private:
    std::uint64_t next_ = 0;
    std::uint32_t last_ = 0;
    bool restarted_ = true;
};

}  // namespace disparityd::capture
