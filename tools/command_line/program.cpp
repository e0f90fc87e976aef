// SPDX-License-Identifier: Apache-2.0
#include "tools/command_line/program.h"

#include <csignal>
#include <exception>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <unistd.h>

#include "base/failure_text.h"
#include "base/file_kind.h"
#include "base/message_text.h"
#include "base/option_tree.h"
#include "base/program_end.h"
#include "base/version.h"
#include "base/words.h"
#include "tools/command_line/printable_output.h"

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

/// Prints --help of the program and its sub-commands as people write options: "--median, --no-median" and not CLI11's
/// "--median,--no-median{false}".
void use_plain_help(CLI::App& app) {
    const auto formatter = std::make_shared<PlainFormatter>();
    app.formatter(formatter);
    for (CLI::App* const command : app.get_subcommands({})) {
        command->formatter(formatter);
    }
}

std::string program = "disparityctl";

void print(const char* kind, const std::string& text) {
    // A progress bar leaves the cursor behind its text. Names in it may hold anything.
    std::cerr << (isatty(STDERR_FILENO) != 0 ? "\r\033[K" : "") << program << ": " << kind << ": "
              << base::printable_line(text) << std::endl;
}

std::string help_of(const CLI::App& app) {
    const auto chosen = app.get_subcommands();
    return app.get_name() + (chosen.empty() ? "" : ' ' + chosen.front()->get_name()) + " --help";
}

/// Says what has happened where a shell has put many names in place of a pattern; empty where it has not.
std::string extra_files(const CLI::App& app) {
    constexpr bool of_sub_commands = true;
    std::vector<std::string> names = app.remaining(of_sub_commands);
    std::erase_if(names, [](const std::string& name) { return !base::is_file(name); });
    if (names.empty()) {
        return {};
    }
    return "found " + base::counted(names.size(), "file name") + " more than allowed, the first is '" +
           base::printable(names.front()) +
           "'; name many images by one pattern, with %d for their numbers: left_%d.png,right_%d.png";
}

/// What is wrong, and what to look at. CLI11 does not say which sub-commands there are.
std::string parse_failure(const CLI::App& app, const CLI::ParseError& error) {
    const std::vector<std::string> unexpected = app.remaining();
    const std::string allowed = sub_commands(app);
    if (!allowed.empty() && app.get_subcommands().empty() && !unexpected.empty() && unexpected.front()[0] != '-') {
        return "found sub-command '" + unexpected.front() + "', allowed: " + allowed + "; see " + help_of(app);
    }
    if (const std::string extra = extra_files(app); !extra.empty()) {
        return extra + "; see " + help_of(app);
    }
    return std::string(error.what()) + "; see " + help_of(app);
}

}  // namespace

std::string sub_commands(const CLI::App& app) {
    std::string names;
    for (const CLI::App* const command : app.get_subcommands(nullptr)) {
        names += (names.empty() ? "" : ", ") + command->get_name();
    }
    return names;
}

void print_error(const std::string& text) {
    print("error", text);
}
void print_note(const std::string& text) {
    print("note", text);
}

namespace {

int exit_code(CLI::App& app, int argc, char** argv, const Action& action) {
    const PrintableOutput printable(std::cout);
    std::signal(SIGXFSZ, SIG_IGN);  // a limit for files is then told as a full disk is
    use_plain_help(app);
    app.set_version_flag("--version", base::version_line(program));
    base::add_option_tree(app);
    try {
        app.parse(argc, argv);
        const int code = action();
        std::cout.flush();
        if (!std::cout) {
            throw std::runtime_error("standard output cannot be written");
        }
        return code;
    } catch (const CLI::Success& help) {
        return app.exit(help);
    } catch (const CLI::ParseError& error) {
        print_error(parse_failure(app, error));
        return exit_user;
    } catch (const std::invalid_argument& error) {
        print_error(error.what());
        return exit_user;
    } catch (const std::exception& error) {
        print_error(base::failure_text(error));
        return exit_failed;
    }
}

}  // namespace

int run_program(CLI::App& app, int argc, char** argv, const Action& action) {
    program = app.get_name();
    return base::end_program(exit_code(app, argc, argv, action));
}

}  // namespace disparityd::tools
