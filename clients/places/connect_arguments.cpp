// SPDX-License-Identifier: Apache-2.0
#include "clients/places/connect_arguments.h"

#include <stdexcept>

#include <CLI/CLI.hpp>

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

}  // namespace disparityd::clients
