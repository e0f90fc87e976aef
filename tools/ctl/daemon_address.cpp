// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/daemon_address.h"

#include <CLI/CLI.hpp>

#include "tools/command_line/program.h"

namespace disparityd::tools {

void DaemonAddress::add_to(CLI::App& app) {
    const std::string group = "Which daemon";
    app.add_option(
           "--socket", socket,
           "tcp:HOST:PORT, tls:HOST:PORT or unix:PATH; default: the Unix socket of NAME, then, for the name default, " +
               std::string(clients::default_tcp))
        ->type_name("ADDRESS")
        ->group(group);
    app.add_option("--name", name, "name of its shared memory and Unix socket, as disparityd --name; default: default")
        ->type_name("NAME")
        ->group(group);
    reach.add_to(app);
}

std::string DaemonAddress::command(const std::string& words) const {
    std::string command = "disparityctl " + words + (name == "default" ? "" : " --name " + name) +
                          (socket.empty() ? "" : " --socket " + socket);
    const disparity::ConnectOptions& options = reach.options;
    for (const auto& [option, value] :
         {std::pair("--authority", &options.authority), std::pair("--certificate", &options.certificate),
          std::pair("--key", &options.key), std::pair("--server-name", &options.server_name),
          std::pair("--token-file", &options.token_file)}) {
        command += value->empty() ? "" : ' ' + std::string(option) + ' ' + *value;
    }
    return command;
}

clients::DaemonSockets DaemonAddress::sockets() const {
    return socket.empty() ? clients::default_sockets(name)
                          : clients::DaemonSockets{{{clients::socket_address(socket)}}, {}, false};
}

disparity::SocketClient connect(const DaemonAddress& daemon, std::chrono::milliseconds timeout) {
    daemon.reach.check(daemon.socket);
    return clients::connect(daemon.sockets(), daemon.name, "disparityctl", print_note, timeout, daemon.reach.options);
}

}  // namespace disparityd::tools
