// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/dataset_range.h"

#include <algorithm>
#include <cmath>

#include "tools/command_line/program.h"
#include "tools/datasets/announced_range.h"

namespace disparityd::tools {
namespace {

constexpr int candidates_step = 16, most_candidates = 256;

std::string candidates(int first, int count) {
    return std::to_string(first) + " to " + std::to_string(first + count - 1) + " px";
}

}  // namespace

int dataset_disparities(const std::string& source, const std::string& calibration, const MatchArguments& match,
                        int usual) {
    auto announced = datasets::range_of_images(source);
    if (!calibration.empty()) {
        const auto of_calibration = datasets::range_of_calibration(calibration);
        announced = of_calibration ? of_calibration : announced;
    }
    if (!announced) {
        return usual;
    }
    const int first = match.d_min();
    const double needed = std::ceil((std::floor(announced->largest) + 1 - first) / candidates_step) * candidates_step;
    const int taken = static_cast<int>(std::clamp(needed, double{candidates_step}, double{most_candidates}));
    const int searched = match.disparities().value_or(taken);
    if (searched < needed) {
        print_note(announced->origin + ", more than is searched: " + candidates(first, searched) +
                   "; what is nearer is not measured" +
                   (match.disparities() && taken > searched ? "; --disparities " + std::to_string(taken) +
                                                                  (taken < needed ? " reaches farther" : " reaches it")
                                                            : ""));
    } else if (!match.disparities() && taken != usual) {
        print_note(announced->origin + ": " + candidates(first, taken) + " are searched");
    }
    return taken;
}

}  // namespace disparityd::tools
