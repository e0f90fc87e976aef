// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

namespace CLI {
class App;
}  // namespace CLI

namespace disparityd::tools {

/// Exit codes of every program here.
enum ExitCode : int {
    exit_done = 0,
    exit_failed = 1,        ///< the system or the daemon refused, or the input ended in a fault
    exit_user = 2,          ///< arguments, input files or calibration must be changed first
    exit_again = 75,        ///< the same command may succeed later: EX_TEMPFAIL of sysexits.h
    exit_interrupted = 130  ///< Ctrl-C before the work was done
};

/// What a program or sub-command does once its arguments are known; returns the exit code.
using Action = std::function<int()>;

/// Adds --version, parses the command line and runs the action that parsing has chosen. Every error becomes one line on
/// stderr, "program: error: ...", and its exit code: std::invalid_argument and bad command lines 2, all others 1.
int run_program(CLI::App& app, int argc, char** argv, const Action& action);

/// The names of the program's sub-commands, "status, watch"; empty if it has none.
std::string sub_commands(const CLI::App& app);

/// "program: error: text" or "program: note: text" on stderr, a progress bar that stands there cleared first.
void print_error(const std::string& text);
void print_note(const std::string& text);

}  // namespace disparityd::tools
