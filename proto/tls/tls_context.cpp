// SPDX-License-Identifier: Apache-2.0
#include "proto/tls/tls_context.h"

#include <array>
#include <cstring>
#include <new>
#include <stdexcept>

#include <arpa/inet.h>
#include <openssl/err.h>
#include <openssl/x509v3.h>
#include <sys/stat.h>

namespace disparityd::proto {
namespace {

void check(bool done, const std::string& file, const std::string& what) {
    if (!done) {
        throw std::invalid_argument(file + ": " + what + ": " + take_tls_error());
    }
}

/// OpenSSL would wait for ever for the bytes of a pipe. A file that is missing it names itself.
void check_is_file(const std::string& file) {
    struct stat facts {};
    if (!file.empty() && ::stat(file.c_str(), &facts) == 0 && !S_ISREG(facts.st_mode)) {
        throw std::invalid_argument(file + ": is not a regular file, allowed: a file in PEM");
    }
}

/// Refuses to ask at the terminal for the password of an encrypted key.
int no_password(char*, int, int, void*) {
    return 0;
}

TlsContext make_context(const SSL_METHOD* method) {
    ERR_clear_error();
    TlsContext context(SSL_CTX_new(method), SSL_CTX_free);
    if (!context) {
        throw std::bad_alloc();
    }
    SSL_CTX_set_min_proto_version(context.get(), TLS1_2_VERSION);
    SSL_CTX_set_options(context.get(), SSL_OP_NO_COMPRESSION | SSL_OP_NO_RENEGOTIATION);
    SSL_CTX_set_default_passwd_cb(context.get(), no_password);
    return context;
}

void use_own(SSL_CTX* context, const TlsFiles& files) {
    if (files.certificate.empty()) {
        return;
    }
    check_is_file(files.certificate);
    check_is_file(files.key);
    check(SSL_CTX_use_certificate_chain_file(context, files.certificate.c_str()) == 1, files.certificate,
          "the certificate cannot be used");
    check(SSL_CTX_use_PrivateKey_file(context, files.key.c_str(), SSL_FILETYPE_PEM) == 1, files.key,
          "the key cannot be used, or is not that of the certificate");
}

/// Refuses a server's certificate that every client would refuse.
void check_is_for_servers(SSL_CTX* context, const std::string& file) {
    X509* const own = SSL_CTX_get0_certificate(context);
    if (own != nullptr && X509_check_purpose(own, X509_PURPOSE_SSL_SERVER, 0) != 1) {
        throw std::invalid_argument(
            file +
            ": the certificate is for another purpose than a server's (extended key usage), and "
            "clients would refuse it, allowed: one for a server, such as the server.crt of "
            "disparityctl certificates");
    }
}

bool has_any(X509_STORE* store, X509_LOOKUP_TYPE type) {
    const STACK_OF(X509_OBJECT)* const objects = X509_STORE_get0_objects(store);
    for (int i = 0; i < sk_X509_OBJECT_num(objects); ++i) {
        if (X509_OBJECT_get_type(sk_X509_OBJECT_value(objects, i)) == type) {
            return true;
        }
    }
    return false;
}

void use_authority(SSL_CTX* context, const std::string& authority) {
    check_is_file(authority);
    check(SSL_CTX_load_verify_locations(context, authority.c_str(), nullptr) == 1, authority,
          "the authority's certificate cannot be used");
    X509_STORE* const store = SSL_CTX_get_cert_store(context);
    if (!has_any(store, X509_LU_X509)) {
        throw std::invalid_argument(authority +
                                    ": holds a list of revoked certificates only, which nobody could be checked by, "
                                    "allowed: the authority's certificate, with or without such a list behind it");
    }
    if (has_any(store, X509_LU_CRL)) {
        X509_STORE_set_flags(store, X509_V_FLAG_CRL_CHECK);  // without a list it would refuse everybody
    }
}

}  // namespace

std::string take_tls_error() {
    // The first one is the cause of those that follow.
    const unsigned long code = ERR_get_error();
    const char* const reason =
        ERR_SYSTEM_ERROR(code) ? std::strerror(ERR_GET_REASON(code)) : ERR_reason_error_string(code);
    const std::string text = reason == nullptr ? "no reason is known" : reason;
    ERR_clear_error();
    return text;
}

bool is_address(const std::string& name) {
    std::array<unsigned char, sizeof(in6_addr)> address{};
    return inet_pton(AF_INET, name.c_str(), address.data()) == 1 ||
           inet_pton(AF_INET6, name.c_str(), address.data()) == 1;
}

TlsContext make_server_tls(const TlsFiles& files, const std::string& name) {
    TlsContext context = make_context(TLS_server_method());
    use_own(context.get(), files);
    check_is_for_servers(context.get(), files.certificate);
    if (!files.authority.empty()) {
        use_authority(context.get(), files.authority);
        // A client sees whose certificates are wanted, and chooses among several.
        SSL_CTX_set_client_CA_list(context.get(), SSL_load_client_CA_file(files.authority.c_str()));
        // Without a name OpenSSL refuses the second connection of a client that goes on with its session.
        SSL_CTX_set_session_id_context(context.get(), reinterpret_cast<const unsigned char*>(name.data()),
                                       static_cast<unsigned>(name.size()));
        SSL_CTX_set_verify(context.get(), SSL_VERIFY_PEER | SSL_VERIFY_FAIL_IF_NO_PEER_CERT, nullptr);
    }
    return context;
}

TlsContext make_client_tls(const TlsFiles& files) {
    if (files.certificate.empty() != files.key.empty()) {
        throw std::invalid_argument("a client's certificate and its key go together: one of them is missing");
    }
    TlsContext context = make_context(TLS_client_method());
    use_own(context.get(), files);
    if (files.authority.empty()) {
        SSL_CTX_set_default_verify_paths(context.get());
    } else {
        use_authority(context.get(), files.authority);
    }
    SSL_CTX_set_verify(context.get(), SSL_VERIFY_PEER, nullptr);
    return context;
}

}  // namespace disparityd::proto
