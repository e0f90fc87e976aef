// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/daemon_address.h"

#include <CLI/CLI.hpp>

#include "tools/command_line/program.h"

namespace disparityd::tools {

void DaemonAddress::add_to(CLI::App& app) {
    const std::string group = "Which daemon";
    app.add_option("--socket", socket,
                   "tcp:HOST:PORT or unix:PATH; default: the Unix socket of NAME, then, for the name default, " +
                       std::string(clients::default_tcp))
        ->type_name("ADDRESS")
        ->group(group);
    app.add_option("--name", name, "name of its shared memory and Unix socket, as disparityd --name; default: default")
        ->type_name("NAME")
        ->group(group);
}

std::string DaemonAddress::command(const std::string& words) const {
    return "disparityctl " + words + (name == "default" ? "" : " --name " + name) +
           (socket.empty() ? "" : " --socket " + socket);
}

clients::DaemonSockets DaemonAddress::sockets() const {
    return socket.empty() ? clients::default_sockets(name)
                          : clients::DaemonSockets{{{clients::socket_address(socket)}}, {}};
}

disparity::SocketClient connect(const DaemonAddress& daemon) {
    return clients::connect(daemon.sockets(), daemon.name, "disparityctl", print_note);
}

bool is_local(const std::string& socket) {
    const auto starts_with = [](const std::string& text, const std::string& start) {
        return text.compare(0, start.size(), start) == 0;
    };
    return starts_with(socket, "unix:") || starts_with(socket, "tcp:127.") || starts_with(socket, "tcp:localhost:") ||
           starts_with(socket, "tcp:[::1]:");
}

}  // namespace disparityd::tools
