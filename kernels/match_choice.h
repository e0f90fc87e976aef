// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "kernels/match_fields.h"

namespace disparityd {

/// What somebody has chosen of the options of matching, all by name. What is not chosen keeps the tuned default.
struct MatchChoice {
    std::string preset;                                  ///< a name of all_presets; empty: the usual one
    std::string cost;                                    ///< a name of all_costs; empty: that of method and preset
    std::map<std::string_view, int, std::less<>> given;  ///< rows of match_fields(), 0 or 1 for a switch

    std::optional<int> of(std::string_view name) const;
};

/// How a name of match_fields(), "preset", "cost" or "method" is written where people choose: "--p2-slope" for
/// "p2_slope" on a command line. All messages of refusals begin with it.
using SpelledOption = std::string (*)(std::string_view name);

/// Throws std::invalid_argument for a word that is no method.
Method method_of(const std::string& word, SpelledOption spelled);

/// Throws std::invalid_argument for a number that the row does not allow; `found` is how it was written.
void check_allowed(const MatchField& field, std::int64_t number, const std::string& found, SpelledOption spelled);

/// Returns the options that the choice stands for: those of the preset (`usual` where none is chosen; SGM alone has
/// presets) with what was given; `disparities` candidates where nothing says how many. Throws std::invalid_argument
/// with one line when a name is unknown, or when options do not fit together.
MatchOptions chosen_options(const MatchChoice& choice, Method method, Preset usual, int disparities,
                            SpelledOption spelled);

/// Throws std::invalid_argument with one line when something is chosen that none of the methods uses.
void check_used(const MatchChoice& choice, std::span<const Method> methods, SpelledOption spelled);

}  // namespace disparityd
