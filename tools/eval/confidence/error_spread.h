// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tools/images/disparity_map.h"

namespace disparityd::eval {

/// How far disparities are from the truth, of pixels that are off by less than 1 px: what is farther off is a wrong
/// match, not an error of the sub-pixel fit. A pixel counts when its truth is known and its confidence is not 0. Each
/// scene that was added has a weight of 1, whatever its size.
class ErrorSpread {
public:
    static constexpr int bin_size = 16;  ///< confidences
    static constexpr std::size_t bin_count = 256 / bin_size;

    /// Adds a scene; one without a pixel that counts adds nothing. Throws std::invalid_argument when the sizes differ.
    void add(const images::FloatMap& disparity, const std::vector<std::uint8_t>& confidence,
             const images::FloatMap& truth);
    void add(const ErrorSpread& other);

    /// Returns one sigma in px of the pixels whose confidence lies in a bin (0: 1 to 15, 15: 240 to 255): 1.4826 times
    /// the median of |disparity - truth|, which is the standard deviation where errors are normally distributed. A bias
    /// counts as error. NaN without pixels.
    double sigma_px(std::size_t bin) const { return sigma_of(weight_.at(bin)); }
    /// Returns the same of all pixels.
    double sigma_px() const { return sigma_of(all()); }
    /// Returns the |disparity - truth| in px that a share of the pixels, 0 to 1, does not exceed. NaN without pixels.
    double quantile_px(double share) const { return quantile_of(all(), share); }

private:
    /// Weights by |disparity - truth| in 1/16 px, rounded. That is the grid on which disparities lie, and the truth of
    /// many data sets; within a cell the weight counts as spread evenly.
    using Cells = std::array<double, 17>;

    static double sigma_of(const Cells& cells);
    static double quantile_of(const Cells& cells, double share);
    Cells all() const;

    std::array<Cells, bin_count> weight_{};
};

}  // namespace disparityd::eval
