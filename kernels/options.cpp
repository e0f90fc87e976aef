// SPDX-License-Identifier: Apache-2.0
#include "kernels/options.h"

#include <algorithm>
#include <array>

#include "kernels/match_fields.h"
#include "kernels/noise/noise_level.h"

namespace disparityd {

namespace {

constexpr std::array<std::string_view, 3> method_names = {"sad", "census", "sgm"};

constexpr std::array<std::string_view, 2> cost_names = {"census-9x7", "census-7x5+gradient"};
constexpr std::array<std::string_view, 3> preset_names = {"paper", "dense", "obstacles"};

std::string out_of_range(std::string_view option, int found, std::string_view allowed) {
    return std::string(option) + " = " + std::to_string(found) + ": allowed is " + std::string(allowed);
}

std::string number_problem(const MatchOptions& options) {
    for (const MatchField& field : match_fields()) {
        if (const int found = field.value(options); !field.allows(found)) {
            return out_of_range(field.name, found, field.allowed());
        }
    }
    const SgmOptions& sgm = options.sgm;
    if (sgm.p1 >= sgm.p2) {
        return out_of_range("p1", sgm.p1, "1 .. " + std::to_string(sgm.p2 - 1) + " (less than p2)");
    }
    return sgm.p2_min <= sgm.p2 ? std::string() : out_of_range("p2_min", sgm.p2_min, "0 .. " + std::to_string(sgm.p2));
}

// Of another method it is a key of SGM that has no effect.
std::string noise_problem(const MatchOptions& options) {
    if (options.noise_level == 0 || options.method != Method::sgm || supports_noise_levels(options)) {
        return {};
    }
    return out_of_range("noise_level", options.noise_level,
                        "0, or more with cost census-7x5+gradient, 4 paths and adaptive_p2");
}

}  // namespace

std::string_view to_string(Method method) {
    return method_names[static_cast<std::size_t>(method)];
}

std::optional<Method> method_from_name(std::string_view text) {
    const auto* const found = std::find(method_names.begin(), method_names.end(), text);
    return found == method_names.end() ? std::nullopt
                                       : std::optional(static_cast<Method>(found - method_names.begin()));
}

std::string_view to_string(CensusCost cost) {
    return cost_names[static_cast<std::size_t>(cost)];
}

std::string_view to_string(Preset preset) {
    return preset_names[static_cast<std::size_t>(preset)];
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
    options.adaptive_noise = true;
    options.sgm = {.paths = 4,
                   .p1 = 15,
                   .p2 = 55,
                   .adaptive_p2 = true,
                   .p2_slope = 3,
                   .p2_min = 18,
                   .calibrated_confidence = true};
    options.post.speckle_step = 1;
    options.post.near_guard = preset == Preset::obstacles;
    options.post.saturated_level = preset == Preset::obstacles ? 250 : 0;
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
    const std::string problem = number_problem(options);
    return problem.empty() ? noise_problem(options) : problem;
}

}  // namespace disparityd
