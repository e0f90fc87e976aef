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

    /// Returns the options of a Client of this name.
    disparity::ClientOptions for_client(const std::string& client_name) const;

private:
    std::string prefix_;
};

/// The options of a command line that say which daemon is meant.
struct DaemonArguments {
    std::string name = "default";  ///< of a daemon of this machine
    std::string socket;            ///< as the user typed it; empty = that daemon
    ConnectArguments reach;

    /// Adds --name, --socket and those of ConnectArguments, with their prefix.
    void add_to(CLI::App& app, const std::string& prefix = "");

    /// Returns a command line that reaches the same daemon, for messages: "disparityctl status --name front".
    std::string command(const std::string& words) const;

    /// Returns the daemon as disparity::connect() takes it. Throws std::invalid_argument with one line for a name that
    /// no daemon can have, an address of another form, and what ConnectArguments::check() refuses.
    std::string where() const;
};

}  // namespace disparityd::clients
