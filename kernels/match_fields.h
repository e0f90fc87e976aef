// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "kernels/options.h"

namespace disparityd {

/// What the configuration and command lines offer, in the order of their messages. to_string() has the names.
inline constexpr std::array all_methods{Method::sgm, Method::census, Method::sad};
inline constexpr std::array all_costs{CensusCost::census_9x7, CensusCost::census_7x5_gradient};
inline constexpr std::array all_presets{Preset::paper, Preset::dense, Preset::obstacles};

/// A row of the table of numbers and switches of matching, of which the configuration, command lines and JSON are made.
struct MatchField {
    std::string_view name;  ///< as the configuration has it: "p2_slope"
    std::variant<int& (*)(MatchOptions&), bool& (*)(MatchOptions&)> field;
    std::string_view help;  ///< what it does, for people; begins with "sgm:" where the other methods do not use it
    int min = 0;            ///< of a number
    int max = 0;
    std::span<const int> one_of = {};  ///< where not all numbers from min to max are allowed
    int step = 1;                      ///< only multiples of it are allowed

    bool is_of_sgm() const { return help.starts_with("sgm:"); }
    bool is_switch() const { return std::holds_alternative<bool& (*)(MatchOptions&)>(field); }
    /// 0 or 1 of a switch, as for set().
    int value(const MatchOptions& options) const;
    void set(MatchOptions& options, int value) const;

    bool allows(std::int64_t value) const;
    std::string allowed() const;  ///< for people, of a number: "1 .. 8", "4 or 8"
};

/// Returns each number and switch once. What more there is of MatchOptions is chosen by name: method, cost.
std::span<const MatchField> match_fields();

}  // namespace disparityd
