// SPDX-License-Identifier: Apache-2.0
#include "clients/command_line/daemon_arguments.h"

#include <stdexcept>

#include <CLI/CLI.hpp>

#include "proto/shared_memory_layout.h"

namespace disparityd::clients {

void ConnectArguments::add_to(CLI::App& app, const std::string& prefix) {
    prefix_ = prefix;
    const auto add = [&](const char* name, std::string& to, const char* type, const char* what) {
        app.add_option("--" + prefix + name, to, what)->type_name(type)->group("How it is reached over tls:HOST:PORT");
    };
    add("authority", options.authority, "FILE",
        "the authority that has signed the daemon's certificate (PEM); default: those that the system trusts");
    add("certificate", options.certificate, "FILE",
        "this client's own certificate (PEM), where the daemon asks for one");
    add("key", options.key, "FILE", "the key of that certificate (PEM)");
    add("server-name", options.server_name, "NAME", "name or address in the daemon's certificate; default: HOST");
    add("token-file", options.token_file, "FILE",
        "a file with the token that the daemon asks for; never sent unencrypted to another machine");
}

void ConnectArguments::check(const std::string& address) const {
    if (options.certificate.empty() != options.key.empty()) {
        throw std::invalid_argument("--" + prefix_ + "certificate and --" + prefix_ +
                                    "key go together: one of them is missing");
    }
    const bool tls = address.compare(0, 4, "tls:") == 0;
    for (const auto& [name, given] :
         {std::pair("authority", &options.authority), std::pair("certificate", &options.certificate),
          std::pair("server-name", &options.server_name)}) {
        if (!tls && !given->empty()) {
            throw std::invalid_argument("--" + prefix_ + name +
                                        ": found without TLS, allowed: with --socket tls:HOST:PORT");
        }
    }
}

disparity::ClientOptions ConnectArguments::for_client(const std::string& client_name) const {
    disparity::ClientOptions to;
    to.client_name = client_name;
    to.reach = options;
    return to;
}

void DaemonArguments::add_to(CLI::App& app, const std::string& prefix) {
    const std::string group = "Which daemon";
    app.add_option("--socket", socket,
                   "tcp:HOST:PORT, tls:HOST:PORT or unix:PATH; default: the daemon of this machine that has the name")
        ->type_name("ADDRESS")
        ->group(group);
    app.add_option("--name", name, "name of the daemon, as disparityd --name; default: default")
        ->type_name("NAME")
        ->group(group);
    reach.add_to(app, prefix);
}

std::string DaemonArguments::command(const std::string& words) const {
    std::string command =
        words + (name == "default" ? "" : " --name " + name) + (socket.empty() ? "" : " --socket " + socket);
    for (const auto& [option, value] :
         {std::pair("--authority", &reach.options.authority), std::pair("--certificate", &reach.options.certificate),
          std::pair("--key", &reach.options.key), std::pair("--server-name", &reach.options.server_name),
          std::pair("--token-file", &reach.options.token_file)}) {
        command += value->empty() ? "" : ' ' + std::string(option) + ' ' + *value;
    }
    return command;
}

std::string DaemonArguments::where() const {
    reach.check(socket);
    if (!proto::is_daemon_name(name)) {
        throw std::invalid_argument("--name: found '" + name + "', allowed: 1 to 64 characters of A-Z a-z 0-9 . _ -");
    }
    const std::string kind = socket.substr(0, socket.find(':') + 1);
    if (!socket.empty() && socket.find('/') == std::string::npos && kind != "unix:" && kind != "tcp:" &&
        kind != "tls:") {
        throw std::invalid_argument(
            "--socket: found '" + socket +
            "', allowed: tcp:HOST:PORT such as tcp:127.0.0.1:9876, tls:HOST:PORT, or unix:PATH");
    }
    return socket.empty() ? name : socket;
}

}  // namespace disparityd::clients
