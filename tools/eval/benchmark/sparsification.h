// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace disparityd::eval {

/// The mean error of the pixels that are left after the least confident k percent were removed, k = 0 .. 99, and the
/// same with the pixels of the largest error removed first. Pixels of equal confidence are removed together, each in
/// part, so that the order of pixels plays no role; of the last pixel a part is removed, too.
struct Sparsification {
    static constexpr std::size_t steps = 100;

    std::array<double, steps> error_px{};
    std::array<double, steps> best_px{};

    /// The area between both curves over the removed share from 0 to 1, in px: AUSE of Ilg et al., "Uncertainty
    /// Estimates and Multi-Hypotheses Networks for Optical Flow", ECCV 2018, as the mean over the steps. 0 is the best.
    double area_px() const;
    /// The same with both curves divided by the mean error of all pixels, as Ilg et al. have it; 0 where that is 0.
    double relative_area() const;
};

/// Of pixels by their errors (px, at least one, all finite) and confidences (larger is surer), in the same order.
Sparsification sparsification(const std::vector<double>& errors, const std::vector<float>& confidences);

}  // namespace disparityd::eval
