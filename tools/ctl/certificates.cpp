// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <iostream>
#include <optional>

#include <CLI/CLI.hpp>

#include "tools/certificates/certificate_files.h"
#include "tools/certificates/revocation.h"
#include "tools/command_line/number_argument.h"
#include "tools/ctl/commands.h"

namespace disparityd::tools {
namespace {

struct CertificateArguments {
    CertificateOrder order;
    std::vector<std::string> revoked;
    std::optional<int> days;
};

std::string joined(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) {
        text += (text.empty() ? "" : ", ") + name;
    }
    return text;
}

/// Says what is there now, and what to do next.
void print(const CertificateOrder& order, const CertificateReport& report) {
    const std::string folder = std::filesystem::absolute(order.folder).lexically_normal().string();
    const std::string in = folder.back() == '/' ? folder : folder + '/';
    if (report.new_authority) {
        std::cout << in << "authority.crt  for every client; authority.key makes more of them: keep it to yourself\n";
    }
    if (report.new_server) {
        std::cout << in << "server.crt     for the daemon, with server.key; it is for " << joined(report.hosts) << '\n';
    }
    for (const std::string& client : order.clients) {
        std::cout << in << client << ".crt  for the client " << client << ", with " << client << ".key\n";
    }
    std::cout << "They are valid until " << report.last_day << ".\n";
    if (report.new_server) {
        std::cout
            << "Next, in the daemon's configuration (its user must be able to read server.key: chown disparityd):\n"
               "  [socket]\n  tcp = \"0.0.0.0:9876\"\n  certificate = \""
            << in << "server.crt\"\n  key = \"" << in << "server.key\"\n  client_authority = \"" << in
            << "authority.crt\"\n";
    }
    const std::string client = order.clients.empty() ? "NAME" : order.clients.front();
    if (order.clients.empty()) {
        std::cout << "A client needs a certificate of its own: disparityctl certificates " << order.folder
                  << " --client NAME\n";
    }
    std::cout << "On the client's machine, with copies of authority.crt, " << client << ".crt and " << client
              << ".key:\n"
              << "  disparityctl watch --socket tls:HOST:9876 --authority authority.crt --certificate " << client
              << ".crt --key " << client << ".key\n";
}

int revoke(const std::string& folder, const std::vector<std::string>& names) {
    revoke_certificates(folder, names);
    std::cout << folder << "/authority.crt has the list of revoked certificates, with " << joined(names)
              << " on it now.\nNext: copy it to where [socket] client_authority is, and reload the daemon (systemctl "
                 "reload disparityd).\nFor another certificate of the same name remove its two files first.\n";
    return exit_done;
}

int certificates(CertificateArguments& arguments) {
    if (!arguments.revoked.empty()) {
        return revoke(arguments.order.folder, arguments.revoked);
    }
    arguments.order.valid = std::chrono::hours(24) * arguments.days.value_or(825);
    const CertificateReport report = make_certificate_files(arguments.order);
    print(arguments.order, report);
    return exit_done;
}

}  // namespace

void add_certificates(CLI::App& program, Action& action) {
    CLI::App& command = *program.add_subcommand(
        "certificates", "Make an authority of your own and certificates for a daemon and its clients (TLS).");
    const auto arguments = std::make_shared<CertificateArguments>();
    command
        .add_option("DIR", arguments->order.folder, "folder of the files; it is made, an authority in it is used again")
        ->required();
    CLI::Option& hosts =
        *command
             .add_option("--host", arguments->order.hosts,
                         "name or address by which clients reach the daemon, may be repeated; default: " +
                             std::string("this machine's name, that with .local, and loopback"))
             ->type_name("NAME")
             ->expected(1)
             ->take_all()
             ->allow_extra_args(false);
    CLI::Option& clients = *command
                                .add_option("--client", arguments->order.clients,
                                            "make a certificate for the client NAME, may be repeated; [access] "
                                            "control_certificates knows it by that")
                                ->type_name("NAME")
                                ->expected(1)
                                ->take_all()
                                ->allow_extra_args(false);
    command
        .add_option(
            "--revoke", arguments->revoked,
            "take back the certificate of the client NAME: it goes on the list in authority.crt; may be repeated")
        ->type_name("NAME")
        ->expected(1)
        ->take_all()
        ->allow_extra_args(false)
        ->excludes(&hosts)
        ->excludes(&clients);
    add_integer(command, "--days", arguments->days, 1, 7300, "how long new certificates are valid; default 825");
    command.footer(
        "No file is replaced but authority.crt by --revoke. Keys have mode 0600, and no password.\n"
        "Examples: disparityctl certificates tls --client laptop\n"
        "          disparityctl certificates tls --client tablet      (later, from the same authority)\n"
        "          disparityctl certificates tls --revoke tablet      (it was lost)\n"
        "          disparityctl certificates tls --host robot.example --host 192.168.1.5 --client laptop");
    command.callback([arguments, &action] { action = [arguments] { return certificates(*arguments); }; });
}

}  // namespace disparityd::tools
