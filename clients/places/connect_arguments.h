// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "clients/cpp/disparity_client.hpp"

namespace CLI {
class App;
}  // namespace CLI

namespace disparityd::clients {

/// The options of a command line that say how a daemon beyond this machine is reached.
struct ConnectArguments {
    disparity::ConnectOptions options;

    /// Adds --authority, --certificate, --key, --server-name and --token-file. `prefix`: "daemon-" makes
    /// --daemon-authority, for a program that has a certificate for other purposes.
    void add_to(CLI::App& app, const std::string& prefix = "");

    /// Throws std::invalid_argument with one line when an option means nothing for this address, "" = the default
    /// places.
    void check(const std::string& address) const;

private:
    std::string prefix_;
};

}  // namespace disparityd::clients
