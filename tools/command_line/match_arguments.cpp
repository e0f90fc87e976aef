// SPDX-License-Identifier: Apache-2.0
#include "tools/command_line/match_arguments.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <CLI/CLI.hpp>

#include "kernels/matcher.h"
#include "tools/command_line/number_argument.h"

namespace disparityd::tools {
namespace {

/// What `text`, given with an option, is the name of.
template <typename Enum>
Enum parse_name(const std::string& option, const std::string& text, std::optional<Enum> (*from_name)(std::string_view),
                const std::string& allowed) {
    if (const auto named = from_name(text)) {
        return *named;
    }
    throw std::invalid_argument(option + ": found '" + text + "', allowed: " + allowed);
}

Preset parse_preset(const std::string& text) {
    return parse_name("--preset", text, preset_from_name, "paper, dense, obstacles");
}

CensusCost parse_cost(const std::string& text) {
    return parse_name("--cost", text, census_cost_from_name, "census-9x7, census-7x5+gradient");
}

template <typename T>
void take(T& to, const std::optional<T>& given) {
    to = given.value_or(to);
}

}  // namespace

void MatchArguments::add_to(CLI::App& app, const std::string& disparities_default, Preset usual) {
    usual_ = usual;
    add_integer(app, "--d-min", d_min_, -256, 256, "smallest candidate in px, -256 .. 256; default 0");
    add_integer(app, "--disparities", disparities_, 16, 256,
                "number of candidates, a multiple of 16 up to 256; " + disparities_default);
    for (CLI::Option* const option :
         {app.add_option("--preset", preset_,
                         "sgm: what all other options begin with: paper (its cost, 8 paths), dense (every pixel) or "
                         "obstacles (measured pixels only); default " +
                             std::string(to_string(usual)))
              ->type_name("PRESET"),
          app.add_option("--cost", cost_, "sgm and census: census-9x7 or census-7x5+gradient")->type_name("COST"),
          add_integer(app, "--paths", paths_, 4, 8, "sgm: paths of aggregation, 4 or 8"),
          add_integer(app, "--p1", p1_, 1, 192, "sgm: penalty of a step of one disparity, less than p2"),
          add_integer(app, "--p2", p2_, 2, 193, "sgm: penalty of a larger step"),
          add_switch(app, "adaptive-p2", adaptive_p2_, "sgm: a smaller p2 across edges of the image"),
          add_integer(app, "--p2-slope", p2_slope_, 1, 8, "sgm: how much smaller per grey level"),
          add_integer(app, "--p2-min", p2_min_, 0, 193, "sgm: the least p2 across edges"),
          add_switch(app, "calibrated-confidence", calibrated_confidence_,
                     "sgm: confidence is the chance in 255ths of an error of at most 1 px, not a ratio of costs"),
          add_switch(app, "subpixel", subpixel_, "disparities in sixteenths of a pixel"),
          add_integer(app, "--uniqueness", uniqueness_, 0, 99,
                      "reject a match when another candidate costs less than N percent more; 0: off"),
          add_switch(app, "local-extrema", local_extrema_, "reject costs without a clear local minimum"),
          add_switch(app, "left-right-check", left_right_check_, "reject what the right image does not confirm"),
          add_integer(app, "--median", median_, 0, 5, "size of the median filter: 0 (off), 3 or 5"),
          add_integer(app, "--speckle-size", speckle_size_, 0, 1'000'000,
                      "reject connected regions of fewer pixels; 0: off"),
          add_integer(app, "--speckle-step", speckle_step_, 0, 256,
                      "neighbours that differ by at most this many px are connected"),
          add_integer(app, "--min-texture", min_texture_, 0, 99,
                      "reject connected regions in which not so many percent of the pixels show texture to both eyes; "
                      "0: off"),
          add_switch(app, "interpolate", interpolate_, "fill rejected pixels from their surroundings"),
          add_integer(app, "--guided-median", guided_median_, 0, 7,
                      "size of a last median, over neighbours of like brightness: 0 (off), 5 or 7")}) {
        option->group("Matching (default: the tuned values of the method)");
    }
}

MatchOptions MatchArguments::options(Method method, int disparities) const {
    const DisparityRange range{d_min(), disparities_.value_or(disparities)};
    MatchOptions options = default_options(method, range);
    if (method == Method::sgm) {
        options = preset_options(preset_.empty() ? usual_ : parse_preset(preset_), range);
    }
    if (!cost_.empty()) {
        options.cost = parse_cost(cost_);
    }
    take(options.sgm.paths, paths_);
    take(options.sgm.p1, p1_);
    take(options.sgm.p2, p2_);
    take(options.sgm.adaptive_p2, adaptive_p2_);
    take(options.sgm.p2_slope, p2_slope_);
    take(options.sgm.p2_min, p2_min_);
    take(options.sgm.calibrated_confidence, calibrated_confidence_);
    take(options.post.subpixel, subpixel_);
    take(options.post.uniqueness, uniqueness_);
    take(options.post.local_extrema, local_extrema_);
    take(options.post.left_right_check, left_right_check_);
    take(options.post.median, median_);
    take(options.post.speckle_size, speckle_size_);
    take(options.post.speckle_step, speckle_step_);
    take(options.post.min_texture, min_texture_);
    take(options.post.interpolate, interpolate_);
    take(options.post.guided_median, guided_median_);
    const std::string wrong = validate(options);
    if (!wrong.empty()) {
        throw std::invalid_argument(wrong);
    }
    return options;
}

void MatchArguments::check_used(const std::vector<Method>& methods) const {
    if (std::find(methods.begin(), methods.end(), Method::sgm) != methods.end()) {
        return;  // it uses all of them
    }
    const std::pair<bool, const char*> of_sgm[] = {{!preset_.empty(), "--preset"},
                                                   {paths_.has_value(), "--paths"},
                                                   {p1_.has_value(), "--p1"},
                                                   {p2_.has_value(), "--p2"},
                                                   {adaptive_p2_.has_value(), "--adaptive-p2"},
                                                   {p2_slope_.has_value(), "--p2-slope"},
                                                   {p2_min_.has_value(), "--p2-min"},
                                                   {calibrated_confidence_.has_value(), "--calibrated-confidence"}};
    std::string chosen;
    for (const Method method : methods) {
        chosen += (chosen.empty() ? "" : " and ") + std::string(to_string(method));
    }
    chosen = chosen.empty() ? "no method of ours" : chosen;
    for (const auto& [given, option] : of_sgm) {
        if (given) {
            throw std::invalid_argument(std::string(option) + ": only the method sgm uses it, found: " + chosen);
        }
    }
    if (!cost_.empty() && std::find(methods.begin(), methods.end(), Method::census) == methods.end()) {
        throw std::invalid_argument("--cost: only the methods sgm and census use it, found: " + chosen);
    }
}

std::string method_help() {
    return "sgm: most pixels, few of them wrong; census: fewest wrong, but rejects many, several times as fast; sad: "
           "fastest, only for eyes of equal brightness";
}

Method parse_method(const std::string& text) {
    return parse_name("--method", text, method_from_name, "sgm, census, sad");
}

std::string backend_help() {
    std::string text = "implementation: auto (the fastest here)";
    for (const Backend& backend : backends()) {
        text += ", " + std::string(backend.name);
    }
    return text;
}

}  // namespace disparityd::tools
