// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

namespace CLI {
class App;
}  // namespace CLI

/// What the bridges' main functions have in common.
namespace disparityd::bridges {

enum ExitStatus : int {
    exit_stopped = 0,  ///< SIGTERM or SIGINT ended it
    exit_failed = 1,   ///< the system refuses
    exit_user = 2,     ///< an argument is wrong
};

/// Adds --version, parses the command line and calls `serve`, which returns when a signal has ended it. Returns the
/// exit status. Every error becomes one line on stderr: std::invalid_argument and bad command lines 2, all others 1.
int run_program(CLI::App& app, int argc, char** argv, const std::function<void()>& serve);

/// Writes "program: kind: text" as one line on stderr. What came from outside may hold anything; a control character
/// becomes "?".
void print_line(const std::string& program, const char* kind, const std::string& text);

}  // namespace disparityd::bridges
