// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stdexcept>
#include <string>

#include "pipeline/distance_limits.h"
#include "tools/command_line/number_argument.h"

namespace disparityd::tools {

/// The options of a command that reject what is nearer or farther.
struct DistanceLimitArguments {
    static constexpr const char* min_option = "--min-distance-m";
    static constexpr const char* max_option = "--max-distance-m";

    void add_to(CLI::App& command) {
        constexpr double most_m = 65;
        add_real(command, min_option, min_m, 0, most_m,
                 "reject what is nearer, as [output] of the daemon does: not in --scan; default 0: no limit");
        add_real(command, max_option, max_m, 0, most_m, "reject what is farther; default 0: no limit");
    }

    /// Throws std::invalid_argument for limits that leave nothing.
    pipeline::DistanceLimits limits() const {
        const pipeline::DistanceLimits limits{min_m.value_or(0), max_m.value_or(0)};
        if (limits.max_m > 0 && limits.max_m <= limits.min_m) {
            throw std::invalid_argument(std::string(max_option) + ": found no more than " + min_option +
                                        ", allowed: more than that, or 0 for no limit");
        }
        return limits;
    }

    std::optional<double> min_m;
    std::optional<double> max_m;
};

}  // namespace disparityd::tools
