// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/match_arguments.h"

#include <stdexcept>

#include <CLI/CLI.hpp>

#include "kernels/matcher.h"
#include "tools/ctl/number_argument.h"

namespace disparityd::tools {
namespace {

template <typename T>
void take(T& to, const std::optional<T>& given) {
    to = given.value_or(to);
}

}  // namespace

void MatchArguments::add_to(CLI::App& app, const std::string& disparities_default) {
    add_integer(app, "--d-min", d_min_, -256, 256, "smallest candidate in px, -256 .. 256; default 0");
    add_integer(app, "--disparities", disparities_, 16, 256,
                "number of candidates, a multiple of 16 up to 256; " + disparities_default);
    const std::string group = "Matching (default: the tuned values of the method)";
    CLI::Option_group& matching = *app.add_option_group(group);
    add_integer(matching, "--paths", paths_, 4, 8, "sgm: paths of aggregation, 4 or 8");
    add_integer(matching, "--p1", p1_, 1, 192, "sgm: penalty of a step of one disparity, less than p2");
    add_integer(matching, "--p2", p2_, 2, 193, "sgm: penalty of a larger step");
    add_switch(matching, "adaptive-p2", adaptive_p2_, "sgm: a smaller p2 across edges of the image");
    add_switch(matching, "subpixel", subpixel_, "disparities in sixteenths of a pixel");
    add_integer(matching, "--uniqueness", uniqueness_, 0, 99,
                "reject a match when another costs less than this many percent more; 0: off");
    add_switch(matching, "local-extrema", local_extrema_, "reject minima that are no clear local minimum");
    add_switch(matching, "left-right-check", left_right_check_, "reject what the right image sees otherwise");
    add_integer(matching, "--median", median_, 0, 5, "size of the median filter: 0 (off), 3 or 5");
    add_integer(matching, "--speckle-size", speckle_size_, 0, 1'000'000,
                "reject connected regions of fewer pixels; 0: off");
    add_integer(matching, "--speckle-step", speckle_step_, 0, 256,
                "neighbours that differ by at most this many px are connected");
    add_switch(matching, "interpolate", interpolate_, "fill rejected pixels from their surroundings");
}

MatchOptions MatchArguments::options(Method method, int disparities) const {
    MatchOptions options = default_options(method, {d_min(), disparities_.value_or(disparities)});
    take(options.sgm.paths, paths_);
    take(options.sgm.p1, p1_);
    take(options.sgm.p2, p2_);
    take(options.sgm.adaptive_p2, adaptive_p2_);
    take(options.post.subpixel, subpixel_);
    take(options.post.uniqueness, uniqueness_);
    take(options.post.local_extrema, local_extrema_);
    take(options.post.left_right_check, left_right_check_);
    take(options.post.median, median_);
    take(options.post.speckle_size, speckle_size_);
    take(options.post.speckle_step, speckle_step_);
    take(options.post.interpolate, interpolate_);
    const std::string wrong = problem(options);
    if (!wrong.empty()) {
        throw std::invalid_argument(wrong);
    }
    return options;
}

Method parse_method(const std::string& text) {
    if (const auto method = method_from_name(text)) {
        return *method;
    }
    throw std::invalid_argument("--method: found '" + text + "', allowed: sgm, census, sad");
}

std::string backend_help() {
    std::string text = "what computes it: auto (the fastest)";
    for (const Backend& backend : backends()) {
        text += ", " + std::string(backend.name);
    }
    return text;
}

}  // namespace disparityd::tools
