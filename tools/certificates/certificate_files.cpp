// SPDX-License-Identifier: Apache-2.0
#include "tools/certificates/certificate_files.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tools/certificates/certificate.h"

namespace disparityd::tools {
namespace {

[[noreturn]] void fail(const std::string& path, const char* what) {
    throw std::runtime_error(path + ": " + what + ": " + std::strerror(errno));
}

using Purpose = CertificateFacts::Purpose;

constexpr mode_t certificate_mode = 0644;
constexpr mode_t key_mode = 0600;

bool exists(const std::string& path) {
    std::error_code error;
    return std::filesystem::symlink_status(path, error).type() != std::filesystem::file_type::not_found;
}

void write_pair(const std::string& stem, const Certificate& made) {
    write_new_file(stem + ".key", made.key_text(), key_mode);
    write_new_file(stem + ".crt", made.certificate_text(), certificate_mode);
}

void check_new(const std::string& stem) {
    for (const char* const ending : {".crt", ".key"}) {
        if (exists(stem + ending)) {
            throw std::invalid_argument(stem + ending +
                                        ": exists already, allowed: a new name; remove it to make it anew");
        }
    }
}

void check_client(const std::string& name) {
    constexpr const char* allowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-._@";
    if (name.empty() || name.size() > 64 || name.front() == '.' ||
        name.find_first_not_of(allowed) != std::string::npos || name == "authority" || name == "server") {
        throw std::invalid_argument(
            "--client: found \"" + name +
            "\", allowed: 1 to 64 letters, digits, '-', '_', '.' and '@', not \"authority\" or \"server\"");
    }
}

/// Throws where what is asked for cannot be made, before anything is written.
void check_order(const CertificateOrder& order, bool has_authority, bool has_server) {
    const std::string folder = order.folder + '/';
    if (!has_authority) {
        check_new(folder + "authority");
    }
    if (!has_server || !order.hosts.empty()) {
        check_new(folder + "server");
    }
    for (auto name = order.clients.begin(); name != order.clients.end(); ++name) {
        check_client(*name);
        check_new(folder + *name);
        if (std::find(order.clients.begin(), name, *name) != name) {
            throw std::invalid_argument("--client: found \"" + *name + "\" twice, allowed: each name once");
        }
    }
    if (has_authority && has_server && order.clients.empty()) {
        throw std::invalid_argument(
            order.folder + ": has an authority and a server's certificate, allowed: --client NAME for one more client");
    }
}

void make_folder(const std::string& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) {
        throw std::runtime_error(folder + ": cannot be made: " + error.message());
    }
}

}  // namespace

void write_new_file(const std::string& path, const std::string& text, mode_t mode) {
    const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode);
    if (file < 0) {
        fail(path, "cannot be made");
    }
    const bool written = ::fchmod(file, mode) == 0 &&
                         ::write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
                         ::fsync(file) == 0;
    const int error = errno;
    ::close(file);
    if (!written) {
        ::unlink(path.c_str());
        errno = error;
        fail(path, "cannot be written");
    }
}

std::vector<std::string> names_of_this_machine() {
    std::array<char, 256> name{};
    std::vector<std::string> names;
    if (::gethostname(name.data(), name.size() - 1) == 0 && name.front() != '\0') {
        const std::string own = name.data();
        names.push_back(own);
        if (own.find('.') == std::string::npos && own != "localhost") {
            names.push_back(own + ".local");
        }
    }
    names.insert(names.end(), {"localhost", "127.0.0.1", "::1"});
    names.erase(std::unique(names.begin(), names.end()), names.end());
    return names;
}

CertificateReport make_certificate_files(const CertificateOrder& order) {
    const std::string folder = order.folder + '/';
    CertificateReport report;
    report.new_authority = !exists(folder + "authority.crt") || !exists(folder + "authority.key");
    const bool has_server = exists(folder + "server.crt") && exists(folder + "server.key");
    check_order(order, !report.new_authority, has_server);
    report.new_server = !has_server;
    CertificateFacts facts;
    // All is made before the first file is written: a name that no certificate can have leaves nothing behind.
    const auto of = [&](Purpose purpose, const std::string& name) {
        // An authority whose end nobody expects would end all others with it.
        constexpr std::chrono::hours ten_years{24 * 3653};
        facts.purpose = purpose;
        facts.common_name = name;
        facts.valid_to = purpose == Purpose::authority ? std::max(order.valid, ten_years) : order.valid;
        return facts;
    };
    const Certificate authority = report.new_authority
                                      ? make_certificate(of(Purpose::authority, "disparityd authority"), nullptr)
                                      : read_authority(folder + "authority.crt", folder + "authority.key");
    std::vector<std::pair<std::string, Certificate>> made;
    if (report.new_server) {
        report.hosts = order.hosts.empty() ? names_of_this_machine() : order.hosts;
        CertificateFacts server = of(Purpose::server, "disparityd");
        server.hosts = report.hosts;
        made.emplace_back("server", make_certificate(server, &authority));
    }
    for (const std::string& client : order.clients) {
        made.emplace_back(client, make_certificate(of(Purpose::client, client), &authority));
    }
    report.last_day = authority.last_day();
    for (const auto& [name, certificate] : made) {
        report.last_day = std::min(report.last_day, certificate.last_day());
    }
    make_folder(order.folder);
    if (report.new_authority) {
        write_pair(folder + "authority", authority);
    }
    for (const auto& [name, certificate] : made) {
        write_pair(folder + name, certificate);
    }
    return report;
}

}  // namespace disparityd::tools
