// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <optional>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tools/eval/halves.h"
#include "tools/eval/means.h"
#include "tools/eval/wins.h"

namespace disparityd::eval {

/// What stands below the lines of the scenes.
struct Summary {
    Measurements measured;
    std::optional<std::vector<Wins>> wins;  ///< where OpenCV was measured on even terms
    std::optional<Halves> halves;
    std::optional<double> noise;  ///< grey levels, where noise was added to the images
};

/// One line for each matcher: the mean of each figure over all scenes.
void print_means(const Measurements& measured, bool markdown, std::ostream& to);

/// Prints each part that there is, with an empty line before it: the scenes won, of each half too; the halves with the
/// names of their scenes and the means of both, each half once as the one to tune on and once as the one to judge on;
/// the noise.
void print_summary(const Summary& summary, bool markdown, std::ostream& to);

/// Returns an object: means (as means_json() has them), won, halves, noise; what there is not is null.
///
/// won is a list of objects: method, backend, scenes (their number), won (number), bad1_nonocc (mean of ours),
/// opencv_bad1_nonocc (mean of the best of OpenCV per scene), lost (names). halves is an object: seed, and for a and b
/// an object: scenes (names), means, won.
nlohmann::ordered_json summary_json(const Summary& summary);

}  // namespace disparityd::eval
