// SPDX-License-Identifier: Apache-2.0
#include "tools/command_line/match_arguments.h"

#include <algorithm>

#include <CLI/CLI.hpp>

#include "kernels/match_choice.h"
#include "kernels/matcher.h"
#include "tools/command_line/number_argument.h"

namespace disparityd::tools {
namespace {

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

bool MatchArguments::any() const {
    return !preset_.empty() || !cost_.empty() ||
           std::any_of(given_.begin(), given_.end(), [](const auto& one) { return one.second.has_value(); });
}

MatchChoice MatchArguments::choice() const {
    MatchChoice chosen{preset_, cost_, {}};
    for (const auto& [name, value] : given_) {
        if (value) {
            chosen.given[name] = *value;
        }
    }
    return chosen;
}

MatchOptions MatchArguments::options(Method method, int disparities) const {
    return chosen_options(choice(), method, usual_, disparities, option_of);
}

void MatchArguments::check_used(const std::vector<Method>& methods) const {
    disparityd::check_used(choice(), methods, option_of);
}

std::string method_help() {
    return "sgm: most pixels, few of them wrong; census: fewest wrong, but rejects many, several times as fast; sad: "
           "fastest, only for eyes of equal brightness";
}

Method parse_method(const std::string& text) {
    return method_of(text, option_of);
}

std::string backend_help() {
    std::string text = "implementation: auto (the fastest here)";
    for (const Backend& backend : backends()) {
        text += ", " + std::string(backend.name);
    }
    return text;
}

}  // namespace disparityd::tools
