// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "clients/command_line/daemon_arguments.h"

namespace disparityd::tools {

using clients::DaemonArguments;

/// So long a daemon may take to answer, unless somebody asks for less.
constexpr std::chrono::milliseconds patience_to_connect = std::chrono::seconds(5);

/// Connects as disparity::connect() does, and throws as it does. Sockets of other users that are left alone are noted.
/// `products`: of the frames that are wanted; none where only requests are sent.
disparity::Client connect(const DaemonArguments& daemon, const std::vector<disparity::Product>& products = {},
                          std::chrono::milliseconds timeout = patience_to_connect);

/// Returns the command of disparityctl that reaches the same daemon, for messages.
std::string command_of(const DaemonArguments& daemon, const std::string& words);

}  // namespace disparityd::tools
