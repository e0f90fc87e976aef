// SPDX-License-Identifier: Apache-2.0
#include <iostream>

#include "tools/ctl/commands.h"
#include "tools/ctl/describe.h"
#include "tools/ctl/source_arguments.h"

namespace disparityd::tools {
namespace {

struct SourcesArguments {
    std::string uri;
    std::string calibration;
    bool json = false;
};

void list_kinds(bool json) {
    Json list = Json::array();
    for (const capture::SourceKind& kind : capture::source_kinds()) {
        if (json) {
            list.push_back({{"name", kind.name}, {"description", kind.description}});
        } else {
            std::cout << kind.name << std::string(kind.name.size() < 12 ? 12 - kind.name.size() : 1, ' ')
                      << kind.description << '\n';
        }
    }
    if (json) {
        std::cout << to_text(list, 2) << '\n';
    }
}

int sources(const SourcesArguments& arguments) {
    if (arguments.uri.empty()) {
        list_kinds(arguments.json);
        return exit_done;
    }
    capture::SourceOptions options;
    options.uri = arguments.uri;
    options.calibration_path = arguments.calibration;
    const auto source = open_with_progress(options);
    const capture::SourceInfo& info = source->info();
    if (arguments.json) {
        std::cout << to_text(to_json(info), 2) << '\n';
    } else {
        std::cout << info.description << '\n' << summary(info) << '\n';
    }
    return exit_done;
}

}  // namespace

void add_sources(CLI::App& program, Action& action) {
    CLI::App& command =
        *program.add_subcommand("sources", "List where frames can come from, or open one source and describe it.");
    const auto arguments = std::make_shared<SourcesArguments>();
    command.add_option("URI", arguments->uri, "a source to open and describe");
    command.add_option("--calibration", arguments->calibration, "calibration instead of the source's own")
        ->type_name("FILE");
    command.add_flag("--json", arguments->json, "a list of objects; with a URI one object");
    command.footer(
        "Examples: disparityctl sources\n"
        "          disparityctl sources scene:hd720@30");
    command.callback([arguments, &action] { action = [arguments] { return sources(*arguments); }; });
}

}  // namespace disparityd::tools
