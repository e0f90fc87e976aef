// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}  // namespace CLI

namespace disparityd::tools {

/// Prints --help of the program and its sub-commands as people write options: "--median, --no-median" and not CLI11's
/// "--median,--no-median{false}".
void use_plain_help(CLI::App& app);

}  // namespace disparityd::tools
