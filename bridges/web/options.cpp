// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/options.h"

#include <stdexcept>

#include <CLI/CLI.hpp>
#include <boost/asio/ip/address.hpp>

#include "bridges/program/host_and_port.h"

namespace disparityd::web {
namespace {

void set_listen(const std::string& text, ServerSettings& settings) {
    const auto at = bridges::parse_host_and_port(text);
    boost::system::error_code error;
    if (at) {
        boost::asio::ip::make_address(at->name, error);
    }
    if (!at || error || at->number > 65535) {
        throw std::invalid_argument("--listen: found \"" + text +
                                    "\", allowed: ADDRESS:PORT such as 127.0.0.1:8765 or 0.0.0.0:8765; port 0 is any");
    }
    settings.host = at->name;
    settings.port = static_cast<std::uint16_t>(at->number);
}

void add_visitors(CLI::App& app, Options& options) {
    const std::string group = "Who may look and control";
    app.add_option("--token-file", options.token_file,
                   "Lines \"view TOKEN\" and \"control TOKEN\"; without a token nobody may look")
        ->type_name("FILE")
        ->group(group);
    app.add_flag("--allow-control", options.allow_control,
                 "Whoever may look may also record and set the camera's controls")
        ->group(group);
    app.add_option("--certificate", options.certificate, "Serve HTTPS with this certificate (PEM, with its chain)")
        ->type_name("FILE")
        ->group(group);
    app.add_option("--key", options.key, "The certificate's key (PEM)")->type_name("FILE")->group(group);
    app.add_option("--client-authority", options.client_authority,
                   "Every client needs a certificate signed by one of these (PEM)")
        ->type_name("FILE")
        ->group(group);
    app.add_flag("--insecure", options.insecure,
                 "Listen beyond this machine although everybody there can look, or read what is sent")
        ->group(group);
    app.add_option("--host", options.hosts, "A further name under which browsers reach this server")
        ->type_name("NAME")
        ->group(group);
    app.add_option("--origin", options.origins,
                   "A page of another server that may use this one, such as "
                   "https://app.example.org")
        ->type_name("URL")
        ->group(group);
}

/// What no browser sends would be taken, and let nobody in.
void check_names(const Options& options) {
    for (const std::string& origin : options.origins) {
        if (!is_origin(origin)) {
            throw std::invalid_argument("--origin: found \"" + origin +
                                        "\", allowed: SCHEME://HOST or SCHEME://HOST:PORT without a path, such as "
                                        "https://app.example.org or http://localhost:8080; file:// for programs on the "
                                        "desktop");
        }
    }
    for (const std::string& host : options.hosts) {
        if (host.empty() || !is_origin("http://" + host) || host.find(':') != std::string::npos) {
            throw std::invalid_argument("--host: found \"" + host +
                                        "\", allowed: a name without scheme, port and path, such as robot.example.org");
        }
    }
}

/// Which daemon is meant says nothing beside all of them, nor does how one elsewhere is reached.
void check_all(const Options& options) {
    const disparity::ConnectOptions& reach = options.daemon.reach.options;
    if (options.all &&
        (options.daemon.name != "default" || !options.daemon.socket.empty() ||
         !(reach.authority + reach.certificate + reach.key + reach.server_name + reach.token_file).empty())) {
        throw std::invalid_argument(
            "--all: found with --name, --socket or a --daemon- option, allowed: without them; it finds the daemons of "
            "this machine by itself. For one elsewhere start another disparity-web");
    }
}

void check_files(const Options& options) {
    if (options.certificate.empty() != options.key.empty()) {
        throw std::invalid_argument("--certificate and --key go together: one of them is missing");
    }
    if (!options.client_authority.empty() && options.certificate.empty()) {
        throw std::invalid_argument("--client-authority needs --certificate and --key");
    }
}

/// Beyond this machine the server wants to know who looks, and that nobody listens in.
void check_reach(const Options& options, const ServerSettings& settings) {
    const bool loopback = boost::asio::ip::make_address(settings.host).is_loopback();
    const bool knows_visitors = !options.token_file.empty() || !options.client_authority.empty();
    if (!loopback && !options.insecure && !(settings.tls.on() && knows_visitors)) {
        throw std::invalid_argument(
            "--listen " + options.listen +
            ": other machines could look at the camera; give --certificate, --key and one of --token-file and "
            "--client-authority, or say --insecure; or reach 127.0.0.1 through ssh -L (docs/web.md)");
    }
}

}  // namespace

void Options::add_to(CLI::App& app) {
    daemon.add_to(app, "daemon-");
    app.add_flag("--all", all,
                 "All daemons of this machine that have their socket at its usual place, each below /i/NAME/; they may "
                 "come and go")
        ->group("Which daemon");
    const std::string group = "Where it serves";
    app.add_option("--listen", listen, "Address and port; [::1]:8765 for IPv6, port 0 for any free one")
        ->type_name("ADDRESS:PORT")
        ->capture_default_str()
        ->group(group);
    app.add_option("--max-connections", max_connections, "Connections of all visitors together")
        ->type_name("NUMBER")
        ->check(CLI::Range(8, 4096))
        ->capture_default_str()
        ->group(group);
    add_visitors(app, *this);
}

ServerSettings Options::settings() const {
    ServerSettings settings;
    settings.daemon = {daemon.where(), daemon.reach.options};
    settings.all = all;
    check_all(*this);
    set_listen(listen, settings);
    check_files(*this);
    settings.tls = {certificate, key, client_authority};
    check_reach(*this, settings);
    check_names(*this);
    settings.access.hosts = hosts;
    settings.access.origins = origins;
    settings.access.anybody_controls = allow_control;
    if (!token_file.empty()) {
        settings.access.tokens = base::read_tokens(token_file);
        settings.access.anybody_views = false;
    }
    settings.max_connections = max_connections;
    return settings;
}

}  // namespace disparityd::web
