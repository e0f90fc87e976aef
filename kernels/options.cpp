// SPDX-License-Identifier: Apache-2.0
#include "kernels/options.h"

#include <algorithm>
#include <array>

namespace disparityd {

namespace {

constexpr std::array<std::string_view, 3> method_names = {"sad", "census", "sgm"};

constexpr std::array<std::string_view, 2> cost_names = {"census-9x7", "census-7x5+gradient"};
constexpr std::array<std::string_view, 3> preset_names = {"paper", "dense", "obstacles"};

template <typename Enum, std::size_t count>
std::optional<Enum> with_name(const std::array<std::string_view, count>& names, std::string_view text) {
    const auto* const found = std::find(names.begin(), names.end(), text);
    if (found == names.end()) {
        return std::nullopt;
    }
    return static_cast<Enum>(found - names.begin());
}

std::string out_of_range(std::string_view option, int found, std::string_view allowed) {
    return std::string(option) + " = " + std::to_string(found) + ": allowed is " + std::string(allowed);
}

std::string outside(std::string_view option, int found, int least, int most) {
    if (found >= least && found <= most) {
        return {};
    }
    return out_of_range(option, found, std::to_string(least) + " to " + std::to_string(most));
}

std::string range_problem(const DisparityRange& range) {
    if (range.count < 16 || range.count > 256 || range.count % 16 != 0) {
        return out_of_range("disparities", range.count, "a multiple of 16, 16 to 256");
    }
    return outside("first disparity", range.first, -256, 256);
}

std::string sgm_problem(const SgmOptions& sgm) {
    if (sgm.paths != 4 && sgm.paths != 8) {
        return out_of_range("paths", sgm.paths, "4 or 8");
    }
    std::string p2 = outside("p2", sgm.p2, 2, 193);
    if (!p2.empty()) {
        return p2 + " (62 + p2 must fit a byte)";
    }
    const std::string p1 = outside("p1", sgm.p1, 1, sgm.p2 - 1);
    if (!p1.empty()) {
        return p1 + " (less than p2)";
    }
    const std::string slope = outside("p2 slope", sgm.p2_slope, 1, 8);
    return slope.empty() ? outside("least p2", sgm.p2_min, 0, sgm.p2) : slope;
}

std::string post_problem(const PostOptions& post) {
    if (post.median != 0 && post.median != 3 && post.median != 5) {
        return out_of_range("median", post.median, "0 (off), 3 or 5");
    }
    if (post.guided_median != 0 && post.guided_median != 5 && post.guided_median != 7) {
        return out_of_range("guided median", post.guided_median, "0 (off), 5 or 7");
    }
    for (const std::string& found :
         {outside("uniqueness", post.uniqueness, 0, 99), outside("speckle size", post.speckle_size, 0, 1 << 26),
          outside("speckle step", post.speckle_step, 0, 256), outside("least texture", post.min_texture, 0, 99)}) {
        if (!found.empty()) {
            return found;
        }
    }
    return {};
}

}  // namespace

std::string_view to_string(Method method) {
    return method_names[static_cast<std::size_t>(method)];
}

std::optional<Method> method_from_name(std::string_view text) {
    return with_name<Method>(method_names, text);
}

std::string_view to_string(CensusCost cost) {
    return cost_names[static_cast<std::size_t>(cost)];
}

std::optional<CensusCost> census_cost_from_name(std::string_view text) {
    return with_name<CensusCost>(cost_names, text);
}

std::string_view to_string(Preset preset) {
    return preset_names[static_cast<std::size_t>(preset)];
}

std::optional<Preset> preset_from_name(std::string_view text) {
    return with_name<Preset>(preset_names, text);
}

MatchOptions default_options(Method method, DisparityRange range) {
    MatchOptions options;
    options.method = method;
    options.range = range;
    options.post.min_texture = 1;
    switch (method) {
        case Method::sad:
            options.post.uniqueness = 8;
            options.post.speckle_size = 50;
            break;
        case Method::census: options.post.speckle_size = 20; break;
        case Method::sgm:
            options.sgm = {.paths = 8, .p1 = 22, .p2 = 60, .adaptive_p2 = true};
            options.post.uniqueness = 3;
            options.post.speckle_size = 150;
            options.post.speckle_step = 2;
            break;
    }
    return options;
}

MatchOptions preset_options(Preset preset, DisparityRange range) {
    MatchOptions options = default_options(Method::sgm, range);
    if (preset == Preset::paper) {
        return options;
    }
    options.cost = CensusCost::census_7x5_gradient;
    options.sgm = {.paths = 4,
                   .p1 = 15,
                   .p2 = 55,
                   .adaptive_p2 = true,
                   .p2_slope = 3,
                   .p2_min = 18,
                   .calibrated_confidence = true};
    options.post.speckle_step = 1;
    if (preset == Preset::dense) {
        options.post.uniqueness = 0;
        options.post.speckle_size = 40;
        options.post.interpolate = true;
        options.post.guided_median = 7;
    }
    return options;
}

bool calibrates_confidence(const MatchOptions& options) {
    return options.method == Method::sgm && options.sgm.calibrated_confidence;
}

std::string validate(const MatchOptions& options) {
    if (options.method != Method::sad && options.method != Method::census && options.method != Method::sgm) {
        return "unknown matching method: allowed are sad, census and sgm";
    }
    if (options.cost != CensusCost::census_9x7 && options.cost != CensusCost::census_7x5_gradient) {
        return "unknown matching cost: allowed are census-9x7 and census-7x5+gradient";
    }
    for (const std::string& found :
         {range_problem(options.range), sgm_problem(options.sgm), post_problem(options.post)}) {
        if (!found.empty()) {
            return found;
        }
    }
    return {};
}

}  // namespace disparityd
