// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/daemon_address.h"

#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include <CLI/CLI.hpp>
#include <unistd.h>

namespace disparityd::tools {
namespace {

constexpr const char* default_tcp = "tcp:127.0.0.1:9876";

bool starts_with(const std::string& text, const std::string& start) {
    return text.compare(0, start.size(), start) == 0;
}

/// The daemon listens in the first of these folders that it may write to.
std::vector<std::string> default_unix_paths(const std::string& name) {
    const std::string file = "disparityd" + (name == "default" ? "" : '-' + name);
    std::vector<std::string> paths{"/run/disparityd/" + file + ".sock"};
    if (const char* runtime = std::getenv("XDG_RUNTIME_DIR"); runtime != nullptr && *runtime != '\0') {
        paths.push_back(std::string(runtime) + '/' + file + ".sock");
    }
    paths.push_back("/tmp/" + file + '-' + std::to_string(getuid()) + ".sock");
    return paths;
}

}  // namespace

void DaemonAddress::add_to(CLI::App& app) {
    const std::string group = "Which daemon";
    app.add_option("--socket", socket,
                   "tcp:HOST:PORT or unix:PATH; default: the Unix socket of NAME, then, for the name default, " +
                       std::string(default_tcp))
        ->type_name("ADDRESS")
        ->group(group);
    app.add_option("--name", name, "its name, that of its shared memory and Unix socket; default: default")
        ->type_name("NAME")
        ->group(group);
}

std::vector<std::string> DaemonAddress::sockets() const {
    if (!socket.empty()) {
        if (starts_with(socket, "tcp:") || starts_with(socket, "unix:")) {
            return {socket};
        }
        if (socket.find('/') != std::string::npos) {
            return {"unix:" + socket};
        }
        throw std::invalid_argument("--socket: found '" + socket +
                                    "', allowed: tcp:HOST:PORT such as tcp:127.0.0.1:9876, or unix:PATH");
    }
    std::vector<std::string> found;
    for (const std::string& path : default_unix_paths(name)) {
        std::error_code error;
        if (std::filesystem::is_socket(path, error)) {
            found.push_back("unix:" + path);
        }
    }
    // Another name is another daemon, which cannot have the default port as well.
    if (name == "default") {
        found.emplace_back(default_tcp);
    }
    return found;
}

disparity::SocketClient connect(const DaemonAddress& daemon) {
    const std::vector<std::string> sockets = daemon.sockets();
    std::string reasons;
    for (const std::string& socket : sockets) {
        try {
            return disparity::SocketClient(socket, "disparityctl");
        } catch (const std::runtime_error& error) {
            const std::string reason = error.what();
            const bool named = reason.find(socket.substr(socket.find(':') + 1)) != std::string::npos;
            reasons += (reasons.empty() ? "" : "; ") + (named ? "" : socket + ": ") + reason;
        }
    }
    if (sockets.empty()) {
        reasons = "there is no Unix socket of a daemon named " + daemon.name;
    }
    throw std::runtime_error("no daemon answers: " + reasons +
                             " (start one with disparityd, or say with --socket where it listens)");
}

bool is_local(const std::string& socket) {
    return starts_with(socket, "unix:") || starts_with(socket, "tcp:127.") || starts_with(socket, "tcp:localhost:") ||
           starts_with(socket, "tcp:[::1]:");
}

}  // namespace disparityd::tools
