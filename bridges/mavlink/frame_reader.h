// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "bridges/mavlink/mavlink_frame.h"

namespace disparityd::mavlink {

/// A frame that has come, of the kind that was asked for.
struct ReceivedFrame {
    std::uint8_t system = 0;
    std::uint8_t component = 0;
    std::vector<std::uint8_t> payload;  ///< as long as its kind says: zeros at the end that were not sent, too
};

/// Finds the frames of one kind in what comes from a link, in MAVLink 2. Any bytes may come. Signatures are not
/// checked. It keeps less than a frame between two calls.
class FrameReader {
public:
    explicit FrameReader(MessageKind kind) : kind_(kind) {}

    /// Takes what came, in order, and calls `found` for each frame with a right checksum.
    void take(std::span<const std::uint8_t> bytes, const std::function<void(const ReceivedFrame& frame)>& found);

private:
    std::size_t take_one(std::span<const std::uint8_t> bytes,
                         const std::function<void(const ReceivedFrame& frame)>& found) const;

    MessageKind kind_;
    std::vector<std::uint8_t> begun_;  ///< the start of a frame
};

}  // namespace disparityd::mavlink
