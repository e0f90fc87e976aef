// SPDX-License-Identifier: Apache-2.0
#include "tools/command_line/number_argument.h"

#include <algorithm>
#include <charconv>
#include <vector>

#include <CLI/CLI.hpp>

#include "base/number_text.h"

namespace disparityd::tools {

CLI::Option* add_integer(CLI::App& app, const std::string& name, std::optional<int>& value, int least, int most,
                         const std::string& description) {
    return add_integer(
        app, name, value, [least, most](int number) { return number >= least && number <= most; },
        "a whole number from " + std::to_string(least) + " to " + std::to_string(most), description);
}

CLI::Option* add_integer(CLI::App& app, const std::string& name, std::optional<int>& value,
                         const std::function<bool(int)>& allows, const std::string& allowed,
                         const std::string& description) {
    const auto take = [&value, name, allows, allowed](const std::string& text) {
        int number = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
        if (error != std::errc() || end != text.data() + text.size() || !allows(number)) {
            throw CLI::ValidationError(name, "found '" + text + "', allowed: " + allowed);
        }
        value = number;
    };
    return app.add_option_function<std::string>(name, take, description)->type_name("N");
}

CLI::Option* add_real(CLI::App& app, const std::string& name, std::optional<double>& value, double least, double most,
                      const std::string& description) {
    const auto take = [&value, name, least, most](const std::string& text) {
        const std::optional<double> number = base::parse_number(text);
        if (!number || *number < least || *number > most) {
            throw CLI::ValidationError(name, "found '" + text + "', allowed: a number from " +
                                                 base::number_text(least) + " to " + base::number_text(most));
        }
        value = number;
    };
    return app.add_option_function<std::string>(name, take, description)->type_name("X");
}

CLI::Option* add_choice(CLI::App& app, const std::string& name, std::string& value,
                        std::initializer_list<const char*> allowed, const std::string& description) {
    const std::vector<std::string> words(allowed.begin(), allowed.end());
    std::string list;
    for (const std::string& word : words) {
        list += (list.empty() ? "" : ", ") + word;
    }
    const auto take = [&value, name, words, list](const std::string& text) {
        if (std::find(words.begin(), words.end(), text) == words.end()) {
            throw CLI::ValidationError(name, "found '" + text + "', allowed: " + list);
        }
        value = text;
    };
    return app.add_option_function<std::string>(name, take, description + ": " + list)->type_name("WORD");
}

CLI::Option* add_switch(CLI::App& app, const std::string& name, std::optional<int>& value,
                        const std::string& description) {
    const auto take = [&value](std::int64_t count) { value = count > 0; };
    return app.add_flag_function("--" + name + ",!--no-" + name, take, description);
}

}  // namespace disparityd::tools
