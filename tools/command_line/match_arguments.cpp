// SPDX-License-Identifier: Apache-2.0
#include "tools/command_line/match_arguments.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include <CLI/CLI.hpp>

#include "kernels/match_fields.h"
#include "kernels/matcher.h"
#include "tools/command_line/number_argument.h"

namespace disparityd::tools {
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

Preset parse_preset(const std::string& text) {
    return parse_name("--preset", text, all_presets);
}

CensusCost parse_cost(const std::string& text) {
    return parse_name("--cost", text, all_costs);
}

/// Returns "--p2-slope" for "p2_slope".
std::string option_of(std::string_view name) {
    std::string option = "--" + std::string(name);
    std::replace(option.begin(), option.end(), '_', '-');
    return option;
}

}  // namespace

void MatchArguments::add_to(CLI::App& app, const std::string& disparities_default, Preset usual) {
    usual_ = usual;
    std::vector<CLI::Option*> all{
        app.add_option("--preset", preset_,
                       "sgm: what all other options begin with: paper (its cost, 8 paths), dense (every pixel) or "
                       "obstacles (measured pixels only); default " +
                           std::string(to_string(usual)))
            ->type_name("PRESET"),
        app.add_option("--cost", cost_, "sgm and census: census-9x7 or census-7x5+gradient")->type_name("COST")};
    for (const MatchField& field : match_fields()) {
        std::optional<int>& value = given_[field.name];
        const std::string option = option_of(field.name);
        std::string help(field.help);
        if (field.is_switch()) {
            all.push_back(add_switch(app, option.substr(2), value, help));
            continue;
        }
        help += "; " + field.allowed() + (field.name == "disparities" ? "; " + disparities_default : "");
        all.push_back(add_integer(
            app, option, value, [&field](int number) { return field.allows(number); }, field.allowed(), help));
    }
    for (CLI::Option* const option : all) {
        option->group("Matching (default: the tuned values of the method)");
    }
}

std::optional<int> MatchArguments::given(std::string_view name) const {
    const auto found = given_.find(name);
    return found == given_.end() ? std::nullopt : found->second;
}

MatchOptions MatchArguments::options(Method method, int disparities) const {
    const DisparityRange range{d_min(), this->disparities().value_or(disparities)};
    MatchOptions options = default_options(method, range);
    if (method == Method::sgm) {
        options = preset_options(preset_.empty() ? usual_ : parse_preset(preset_), range);
    }
    if (!cost_.empty()) {
        options.cost = parse_cost(cost_);
    }
    for (const MatchField& field : match_fields()) {
        if (const auto value = given(field.name)) {
            field.set(options, *value);
        }
    }
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
    std::string chosen;
    for (const Method method : methods) {
        chosen += (chosen.empty() ? "" : " and ") + std::string(to_string(method));
    }
    chosen = chosen.empty() ? "no method of ours" : chosen;
    const auto refuse_where = [&chosen](bool found, const std::string& option) {
        if (found) {
            throw std::invalid_argument(option + ": only the method sgm uses it, found: " + chosen);
        }
    };
    refuse_where(!preset_.empty(), "--preset");
    for (const MatchField& field : match_fields()) {
        refuse_where(field.is_of_sgm() && given(field.name), option_of(field.name));
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
    return parse_name("--method", text, all_methods);
}

std::string backend_help() {
    std::string text = "implementation: auto (the fastest here)";
    for (const Backend& backend : backends()) {
        text += ", " + std::string(backend.name);
    }
    return text;
}

}  // namespace disparityd::tools
