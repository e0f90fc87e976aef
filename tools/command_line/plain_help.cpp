// SPDX-License-Identifier: Apache-2.0
#include "tools/command_line/plain_help.h"

#include <memory>
#include <string>
#include <string_view>

#include <CLI/CLI.hpp>

namespace disparityd::tools {
namespace {

class PlainFormatter : public CLI::Formatter {
public:
    std::string make_option_name(const CLI::Option* option, bool is_positional) const override {
        std::string name = CLI::Formatter::make_option_name(option, is_positional);
        constexpr std::string_view value_of_opposite = "{false}";
        if (const auto at = name.find(value_of_opposite); at != std::string::npos) {
            name.erase(at, value_of_opposite.size());
        }
        return name;
    }
};

}  // namespace

void use_plain_help(CLI::App& app) {
    const auto formatter = std::make_shared<PlainFormatter>();
    app.formatter(formatter);
    for (CLI::App* const command : app.get_subcommands({})) {
        command->formatter(formatter);
    }
}

}  // namespace disparityd::tools
