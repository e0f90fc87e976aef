// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <sys/stat.h>

#include "proto/tls/tls_context.h"
#include "tests/temporary_folder.h"
#include "tools/certificates/certificate.h"
#include "tools/certificates/revocation.h"

namespace disparityd::test {

/// Certificates of an authority, of a server at 127.0.0.1 and "localhost", and of clients.
class CertificateFolder {
public:
    using Facts = tools::CertificateFacts;

    CertificateFolder() {
        write("authority", authority_);
        make({.purpose = Facts::Purpose::server, .common_name = "server", .hosts = {"127.0.0.1", "localhost"}});
    }

    /// Makes NAME.crt and NAME.key, signed by the authority or by `other`.
    void make(const Facts& facts, const tools::Certificate* other = nullptr) {
        write(facts.common_name, tools::make_certificate(facts, other == nullptr ? &authority_ : other));
    }

    void revoke(const std::string& name) { tools::revoke_certificates(folder_.path(), {name}); }

    void write(const std::string& name, const tools::Certificate& certificate) {
        folder_.write(name + ".crt", certificate.certificate_text());
        ::chmod(folder_.write(name + ".key", certificate.key_text()).c_str(), 0600);
    }

    std::string file(const std::string& name) const { return folder_.file(name); }
    std::string write_secret(const std::string& name, const std::string& text) const {
        const std::string path = folder_.write(name, text);
        ::chmod(path.c_str(), 0600);
        return path;
    }

    /// What a server is told. With `clients` each needs a certificate of the authority.
    proto::TlsFiles server(bool clients = false) const {
        return {file("server.crt"), file("server.key"), clients ? file("authority.crt") : ""};
    }

    /// What a client is told; an empty name: it has no certificate.
    proto::TlsFiles client(const std::string& name = "") const {
        return {name.empty() ? "" : file(name + ".crt"), name.empty() ? "" : file(name + ".key"),
                file("authority.crt")};
    }

private:
    static Facts of_authority() {
        return {.purpose = Facts::Purpose::authority, .common_name = "authority of the tests"};
    }

    TemporaryFolder folder_;
    tools::Certificate authority_ = tools::make_certificate(of_authority(), nullptr);
};

}  // namespace disparityd::test
