// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "calibration/board/board.h"
#include "kernels/image.h"

namespace disparityd::calibration {

/// Finds out, of frames in which the expected board was not found, whether they show another one: other numbers of
/// corners, markers of another family, markers where none are expected, or none where some are.
class OtherBoard {
public:
    /// `enough_frames`: so many must show the same board before it is named.
    explicit OtherBoard(const Board& expected, int enough_frames = 3)
        : expected_(expected), enough_frames_(enough_frames) {}

    /// Looks at one eye. Takes a second for a large image: a few frames of a session are enough.
    void look_at(Plane<const std::uint8_t> eye);

    /// Returns one line, "the board has 7 x 5 inner corners, not 9 x 6: --columns 7 --rows 5"; empty while so
    /// many frames have not shown the same other board. A board that reaches beyond the image shows fewer corners than
    /// it has: their number changes from frame to frame.
    std::string finding() const;

private:
    const Board expected_;
    const int enough_frames_;
    std::map<std::string, int> seen_;  ///< how many frames say what
};

}  // namespace disparityd::calibration
