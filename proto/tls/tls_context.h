// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include <openssl/ssl.h>

namespace disparityd::proto {

/// What connections of one end have in common. Any number of connections, of any threads, may use one.
using TlsContext = std::shared_ptr<SSL_CTX>;

/// Files in PEM. Empty names: none.
struct TlsFiles {
    std::string certificate;  ///< this end's own, with its chain
    std::string key;          ///< of that certificate, not encrypted
    std::string authority;  ///< the other end's certificate must be signed by one of these. Where the file has lists of
                            ///< revoked certificates, too, each authority in it needs one, and these are refused
    bool on() const { return !certificate.empty(); }
};

/// Makes the context of a server, for TLS 1.2 and newer. With an authority every client must have a certificate. `name`
/// is the program's. Throws std::invalid_argument with one line when a file cannot be used: which, why. So is a
/// certificate that is not for a server, an authority of which there is only a list of revoked ones, and a pipe.
TlsContext make_server_tls(const TlsFiles& files, const std::string& name);

/// Makes the context of a client, for TLS 1.2 and newer. The server's certificate is always checked: against the
/// authority, without one against the authorities that the system trusts. Throws as make_server_tls().
TlsContext make_client_tls(const TlsFiles& files);

/// Returns the reason of OpenSSL's first error in this thread, and forgets all of them.
std::string take_tls_error();

/// Returns whether the text is an IP address, which certificates have in another field than names.
bool is_address(const std::string& name);

}  // namespace disparityd::proto
