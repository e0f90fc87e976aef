// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "obstacles/scan_options.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace disparityd::tools {

/// The options of an obstacle scan as the command line has them: KEY=VALUE, with the names and ranges of the section
/// [scan] of the daemon's configuration, and subpixel_error_px of [match].
class ScanArguments {
public:
    /// Adds --scan-set, which may be given several times.
    CLI::Option* add_to(CLI::App& app);

    /// Returns the options. The least confidence is 1 where it is not given and a confidence is a ratio of costs
    /// (`calibrated` is false). Throws std::invalid_argument with one line for what is not allowed.
    ScanOptions options(bool calibrated) const;

private:
    std::vector<std::string> settings_;  ///< as typed
};

}  // namespace disparityd::tools
