// SPDX-License-Identifier: Apache-2.0
#include "kernels/match_fields.h"

#include <algorithm>
#include <array>

namespace disparityd {
namespace {

constexpr std::array path_counts{4, 8};
constexpr std::array median_sizes{0, 3, 5};
constexpr std::array guided_sizes{0, 5, 7};

// Shorthand for the way from the options to a field.
#define FIELD(member) [](MatchOptions& options) -> decltype((options.member)) { return options.member; }

constexpr std::array fields{
    MatchField{"d_min", FIELD(range.first), "smallest candidate in px", -256, 256},
    MatchField{"disparities", FIELD(range.count), "number of candidates", 16, 256, {}, 16},
    MatchField{"paths", FIELD(sgm.paths), "sgm: paths of aggregation", 4, 8, path_counts},
    MatchField{"p1", FIELD(sgm.p1), "sgm: penalty of a step of one disparity, less than p2", 1, 192},
    MatchField{"p2", FIELD(sgm.p2), "sgm: penalty of a larger step", 2, 193},
    MatchField{"adaptive_p2", FIELD(sgm.adaptive_p2), "sgm: a smaller p2 across edges of the image"},
    MatchField{"p2_slope", FIELD(sgm.p2_slope), "sgm: how much smaller per grey level", 1, 8},
    MatchField{"p2_min", FIELD(sgm.p2_min), "sgm: the smallest p2 across edges, at most p2", 0, 193},
    MatchField{"calibrated_confidence", FIELD(sgm.calibrated_confidence),
               "sgm: confidence is the chance in 255ths of an error of at most 1 px, not a ratio of costs"},
    MatchField{"subpixel", FIELD(post.subpixel), "disparities in sixteenths of a pixel"},
    MatchField{"local_extrema", FIELD(post.local_extrema), "reject costs without a clear local minimum"},
    MatchField{"uniqueness", FIELD(post.uniqueness),
               "reject a match when another candidate costs less than N percent more, 0 = off", 0, 99},
    MatchField{"left_right_check", FIELD(post.left_right_check), "reject what the right image does not confirm"},
    MatchField{"median", FIELD(post.median), "size of the median filter, 0 = off", 0, 5, median_sizes},
    MatchField{"speckle_size", FIELD(post.speckle_size), "reject connected regions of fewer pixels, 0 = off", 0,
               1'000'000},
    MatchField{"speckle_step", FIELD(post.speckle_step), "neighbours that differ by at most this many px are connected",
               0, 256},
    MatchField{"min_texture", FIELD(post.min_texture),
               "reject connected regions in which not N percent of the pixels show texture to both eyes, 0 = off", 0,
               99},
    MatchField{"interpolate", FIELD(post.interpolate), "fill rejected pixels from their surroundings"},
    MatchField{"guided_median", FIELD(post.guided_median),
               "size of a last median, over neighbours of like brightness, 0 = off", 0, 7, guided_sizes},
    MatchField{
        "noise_level", FIELD(noise_level),
        "sgm: match for pictures with so much noise, 0 = none; 1, 2 and 3 are for a sigma from 1.75, 2.2 and 3.2 "
        "grey levels on",
        0, 3},
    MatchField{"adaptive_noise", FIELD(adaptive_noise),
               "sgm: take the noise level of each frame from the noise of those before it, at least noise_level"},
    MatchField{"near_guard", FIELD(post.near_guard), "reject what a coarse match finds to be nearer than the range"},
    MatchField{"saturated_level", FIELD(post.saturated_level),
               "with near_guard: reject wide areas in which the left eye is at least so bright, 0 = off", 0, 255},
};

#undef FIELD

}  // namespace

int MatchField::value(const MatchOptions& options) const {
    MatchOptions copy = options;
    return std::visit([&copy](auto of) -> int { return of(copy); }, field);
}

void MatchField::set(MatchOptions& options, int value) const {
    if (const auto* const flag = std::get_if<bool& (*)(MatchOptions&)>(&field)) {
        (*flag)(options) = value != 0;
    } else {
        std::get<int& (*)(MatchOptions&)>(field)(options) = value;
    }
}

bool MatchField::allows(std::int64_t value) const {
    if (!one_of.empty()) {
        return std::find(one_of.begin(), one_of.end(), value) != one_of.end();
    }
    return is_switch() || (value >= min && value <= max && value % step == 0);
}

std::string MatchField::allowed() const {
    if (one_of.empty()) {
        return (step > 1 ? "a multiple of " + std::to_string(step) + ", " : "") + std::to_string(min) + " .. " +
               std::to_string(max);
    }
    std::string list = std::to_string(one_of.front());
    for (const int number : one_of.subspan(1)) {
        list += (number == one_of.back() ? " or " : ", ") + std::to_string(number);
    }
    return list;
}

std::span<const MatchField> match_fields() {
    return fields;
}

}  // namespace disparityd
