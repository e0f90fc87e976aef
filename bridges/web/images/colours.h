// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "bridges/web/images/image_view.h"

namespace disparityd::web {

/// Blue, green, red.
using Colour = std::array<std::uint8_t, 3>;

/// 256 colours from far, blue, over green to near, red: the map "turbo". It has no black, which marks rejected pixels.
const std::array<Colour, 256>& turbo();

/// A colour for each disparity that a frame can hold.
class DisparityColours {
public:
    /// `image` is disparity (linear in disparity) or depth (linear in depth). Without a range: what the searched
    /// disparities can show; of depth, up to eight times the nearest distance. Throws std::runtime_error for a frame
    /// that no daemon makes.
    DisparityColours(const disparity::FrameInfo& frame, Image image, const std::optional<RangeM>& range);

    /// Takes any value; one that is not searched has the colour of the nearest end, a rejected one is black.
    const Colour& of(std::int16_t disparity16) const;

    double low = 0;                ///< 1/16 px, or mm of depth: the value with the far end's colour, or the near end's
    double high = 0;               ///< the other end, the larger value
    std::optional<double> near_m;  ///< as EncodedImage
    std::optional<double> far_m;   ///< as EncodedImage

private:
    void fill(const disparity::FrameInfo& frame, Image image);

    int invalid_ = 0;
    std::vector<Colour> colours_;  ///< from invalid_ on
};

}  // namespace disparityd::web
