// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tools/eval/confidence/error_spread.h"
#include "tools/eval/confidence/reliability.h"

namespace disparityd::eval {

/// The reliability of one matcher on one set of scenes.
struct NamedReliability {
    std::string name;  ///< method, back end and, of a half, which one
    Reliability counted;
    ErrorSpread errors;
};

/// A table of the bins that have pixels, with four columns for each matcher: share of the pixels, what their
/// confidence says on average, and share of the right ones, all in percent, and sigma in px as ErrorSpread has it;
/// below it calibration error, sparsification area and sigma of all.
void print_reliability(const std::vector<NamedReliability>& all, bool markdown, std::ostream& to);

/// Returns a list of objects: name, calibration_error, sparsification_area, sigma_px, sigma_px_of_bins (16 numbers,
/// null where there is no pixel), weight (256 numbers) and right (256).
nlohmann::ordered_json reliability_json(const std::vector<NamedReliability>& all);

}  // namespace disparityd::eval
