// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace disparityd::capture {

/// Where the eyes are in the frame that a camera sends.
struct EyeLayout {
    int eye_width = 0;  ///< pixels
    int eye_height = 0;
    bool top_bottom = false;   ///< one above the other instead of side by side
    bool right_first = false;  ///< the right eye is the left or upper one, or has the first byte
    bool interleaved = false;  ///< a byte of each eye in turn, instead of side by side; never with top_bottom

    int frame_width() const { return top_bottom || interleaved ? eye_width : 2 * eye_width; }
    int frame_height() const { return top_bottom ? 2 * eye_height : eye_height; }

    /// Whether a frame is lent as it was sent: side by side, the left eye first.
    bool as_lent() const { return !top_bottom && !right_first && !interleaved; }

    bool operator==(const EyeLayout&) const = default;
};

}  // namespace disparityd::capture
