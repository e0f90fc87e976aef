// SPDX-License-Identifier: Apache-2.0
#include "kernels/noise/noise_level.h"

#include <algorithm>
#include <array>

#include "kernels/matcher.h"

namespace disparityd {

bool supports_noise_levels(const MatchOptions& options) {
    return options.method == Method::sgm && options.cost == CensusCost::census_7x5_gradient && options.sgm.paths == 4 &&
           options.sgm.adaptive_p2;
}

bool adapts_to_noise(const MatchOptions& options) {
    return options.adaptive_noise && supports_noise_levels(options);
}

bool has_noise_levels(const MatchOptions& options) {
    return adapts_to_noise(options) || (options.noise_level > 0 && supports_noise_levels(options));
}

int noise_level_of(const MatchOptions& options, const FrameView& frame) {
    if (!supports_noise_levels(options)) {
        return 0;
    }
    return options.adaptive_noise ? std::max(options.noise_level, frame.noise_level) : options.noise_level;
}

MatchOptions at_noise_level(const MatchOptions& options, int noise_level) {
    if (noise_level == 0) {
        return options;
    }
    constexpr std::array least_uniqueness = {0, 3, 8, 16};
    MatchOptions changed = options;
    changed.sgm.p1 = 20;
    changed.sgm.p2 = 63;  // sums of four paths fit a byte
    changed.sgm.p2_slope = 2;
    changed.sgm.p2_min = 23;
    changed.post.uniqueness =
        std::max(options.post.uniqueness, least_uniqueness[static_cast<std::size_t>(noise_level)]);
    return changed;
}

}  // namespace disparityd
