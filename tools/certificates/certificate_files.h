// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include <sys/types.h>

namespace disparityd::tools {

/// Writes a new file, from the beginning with its mode; never over a file or through a link of somebody else. Throws
/// std::runtime_error with one line when the system refuses; then there is no file.
void write_new_file(const std::string& path, const std::string& text, mode_t mode);

/// What is to be in a folder of certificates.
struct CertificateOrder {
    std::string folder;
    std::vector<std::string> hosts;    ///< names and addresses of the server; empty: those of this machine
    std::vector<std::string> clients;  ///< common names, which are names of files too
    std::chrono::hours valid{};
};

/// What was made.
struct CertificateReport {
    bool new_authority = false;
    bool new_server = false;
    std::vector<std::string> hosts;  ///< of a new server's certificate
    std::string last_day;            ///< of the first that ends, "2031-05-07"
};

/// Makes the folder and in it NAME.crt (mode 0644) and NAME.key (0600) of an authority, of a server and of each client.
/// The authority of before is used again, and its server's certificate kept. No file is replaced. Throws
/// std::invalid_argument with one line, before anything is written, when a file that is asked for exists or nothing is
/// asked for; std::runtime_error when the system refuses.
CertificateReport make_certificate_files(const CertificateOrder& order);

/// Returns the names by which this machine is reached by default: its own, that with ".local", and loopback.
std::vector<std::string> names_of_this_machine();

}  // namespace disparityd::tools
