// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "bridges/web/server.h"
#include "clients/command_line/daemon_arguments.h"

namespace CLI {
class App;
}  // namespace CLI

namespace disparityd::web {

/// The command line.
struct Options {
    clients::DaemonArguments daemon;
    bool all = false;
    std::string listen = "127.0.0.1:8765";
    std::string token_file;
    bool allow_control = false;
    std::string certificate;
    std::string key;
    std::string client_authority;
    bool insecure = false;
    std::vector<std::string> hosts;
    std::vector<std::string> origins;
    int max_connections = 128;

    void add_to(CLI::App& app);

    /// Reads the tokens, and returns what the server is told. Throws std::invalid_argument with one line: which option,
    /// found, allowed; also where others could look without a word from the user.
    ServerSettings settings() const;
};

}  // namespace disparityd::web
