// SPDX-License-Identifier: Apache-2.0
#include "kernels/match_choice.h"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace disparityd {
namespace {

/// Returns the one of `all` that `text`, given with an option, is the name of.
template <typename Enum, std::size_t count>
Enum parse_name(const std::string& option, const std::string& text, const std::array<Enum, count>& all) {
    std::string allowed;
    for (const Enum one : all) {
        if (to_string(one) == text) {
            return one;
        }
        allowed += (allowed.empty() ? "" : ", ") + std::string(to_string(one));
    }
    throw std::invalid_argument(option + ": found '" + text + "', allowed: " + allowed);
}

}  // namespace

std::optional<int> MatchChoice::of(std::string_view name) const {
    const auto found = given.find(name);
    return found == given.end() ? std::nullopt : std::optional(found->second);
}

Method method_of(const std::string& word, SpelledOption spelled) {
    return parse_name(spelled("method"), word, all_methods);
}

void check_allowed(const MatchField& field, std::int64_t number, const std::string& found, SpelledOption spelled) {
    if (!field.allows(number)) {
        throw std::invalid_argument(spelled(field.name) + ": found '" + found + "', allowed: " + field.allowed());
    }
}

MatchOptions chosen_options(const MatchChoice& choice, Method method, Preset usual, int disparities,
                            SpelledOption spelled) {
    const DisparityRange range{choice.of("d_min").value_or(0), choice.of("disparities").value_or(disparities)};
    MatchOptions options = default_options(method, range);
    if (method == Method::sgm) {
        options = preset_options(
            choice.preset.empty() ? usual : parse_name(spelled("preset"), choice.preset, all_presets), range);
    }
    if (!choice.cost.empty()) {
        options.cost = parse_name(spelled("cost"), choice.cost, all_costs);
    }
    for (const MatchField& field : match_fields()) {
        if (const auto value = choice.of(field.name)) {
            field.set(options, *value);
        }
    }
    const std::string wrong = validate(options);
    if (!wrong.empty()) {
        throw std::invalid_argument(wrong);
    }
    return options;
}

void check_used(const MatchChoice& choice, std::span<const Method> methods, SpelledOption spelled) {
    if (std::find(methods.begin(), methods.end(), Method::sgm) != methods.end()) {
        return;  // it uses all of them
    }
    std::string chosen;
    for (const Method method : methods) {
        chosen += (chosen.empty() ? "" : " and ") + std::string(to_string(method));
    }
    chosen = chosen.empty() ? "no method of ours" : chosen;
    const auto refuse_where = [&](bool found, std::string_view option) {
        if (found) {
            throw std::invalid_argument(spelled(option) + ": only the method sgm uses it, found: " + chosen);
        }
    };
    refuse_where(!choice.preset.empty(), "preset");
    for (const MatchField& field : match_fields()) {
        refuse_where(field.is_of_sgm() && choice.of(field.name), field.name);
    }
    if (!choice.cost.empty() && std::find(methods.begin(), methods.end(), Method::census) == methods.end()) {
        throw std::invalid_argument(spelled("cost") + ": only the methods sgm and census use it, found: " + chosen);
    }
}

}  // namespace disparityd
