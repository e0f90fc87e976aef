// SPDX-License-Identifier: Apache-2.0
#include "proto/tls/tls_stream.h"

#include <algorithm>
#include <cerrno>
#include <new>

#include <openssl/err.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>
#include <sys/socket.h>

namespace disparityd::proto {
namespace {

int socket_of(BIO* bio) {
    return static_cast<int>(reinterpret_cast<std::intptr_t>(BIO_get_data(bio)));
}

bool may_come_later(int error) {
    return error == EAGAIN || error == EWOULDBLOCK || error == EINTR;
}

int bio_write(BIO* bio, const char* bytes, int length) {
    BIO_clear_retry_flags(bio);
    const ssize_t sent = ::send(socket_of(bio), bytes, static_cast<std::size_t>(length), MSG_NOSIGNAL);
    if (sent < 0 && may_come_later(errno)) {
        BIO_set_retry_write(bio);
    }
    return static_cast<int>(sent);
}

int bio_read(BIO* bio, char* bytes, int length) {
    BIO_clear_retry_flags(bio);
    const ssize_t received = ::recv(socket_of(bio), bytes, static_cast<std::size_t>(length), 0);
    if (received < 0 && may_come_later(errno)) {
        BIO_set_retry_read(bio);
    }
    if (received == 0) {
        BIO_set_flags(bio, BIO_FLAGS_IN_EOF);
    }
    return static_cast<int>(received);
}

long bio_control(BIO* bio, int command, long, void*) {
    switch (command) {
        case BIO_CTRL_FLUSH: return 1;
        case BIO_CTRL_EOF: return BIO_test_flags(bio, BIO_FLAGS_IN_EOF) != 0 ? 1 : 0;
        default: return 0;
    }
}

int bio_create(BIO* bio) {
    BIO_set_init(bio, 1);
    return 1;
}

void set_socket(BIO* bio, int socket) {
    BIO_set_data(bio, reinterpret_cast<void*>(static_cast<std::intptr_t>(socket)));
}

/// OpenSSL's own BIO of a socket writes with write(), which raises SIGPIPE in programs that do not ignore it.
const BIO_METHOD* quiet_socket() {
    static BIO_METHOD* const method = [] {
        BIO_METHOD* const made = BIO_meth_new(BIO_get_new_index() | BIO_TYPE_SOURCE_SINK, "socket without SIGPIPE");
        if (made != nullptr) {
            BIO_meth_set_write(made, bio_write);
            BIO_meth_set_read(made, bio_read);
            BIO_meth_set_ctrl(made, bio_control);
            BIO_meth_set_create(made, bio_create);
        }
        return made;
    }();
    return method;
}

}  // namespace

TlsStream::TlsStream(const TlsContext& context, int socket, End end) : ssl_(SSL_new(context.get()), SSL_free) {
    BIO* const bio = ssl_ && quiet_socket() != nullptr ? BIO_new(quiet_socket()) : nullptr;
    if (bio == nullptr) {
        ERR_clear_error();
        throw std::bad_alloc();
    }
    set_socket(bio, socket);
    SSL_set_bio(ssl_.get(), bio, bio);
    // The planes of a frame may move between two calls; a connection that is idle keeps no buffers.
    SSL_set_mode(ssl_.get(),
                 SSL_MODE_ENABLE_PARTIAL_WRITE | SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER | SSL_MODE_RELEASE_BUFFERS);
    if (end == End::server) {
        SSL_set_accept_state(ssl_.get());
    } else {
        SSL_set_connect_state(ssl_.get());
    }
}

TlsStream::~TlsStream() = default;

void TlsStream::expect_server(const std::string& name) {
    if (is_address(name)) {
        X509_VERIFY_PARAM_set1_ip_asc(SSL_get0_param(ssl_.get()), name.c_str());
        return;
    }
    SSL_set_tlsext_host_name(ssl_.get(), name.c_str());
    SSL_set_hostflags(ssl_.get(), X509_CHECK_FLAG_NO_PARTIAL_WILDCARDS);
    SSL_set1_host(ssl_.get(), name.c_str());
}

TlsStream::Outcome TlsStream::outcome_of(int result) {
    switch (SSL_get_error(ssl_.get(), result)) {
        case SSL_ERROR_NONE: return Outcome::done;
        case SSL_ERROR_WANT_READ: return Outcome::wants_read;
        case SSL_ERROR_WANT_WRITE: return Outcome::wants_write;
        case SSL_ERROR_ZERO_RETURN:
        case SSL_ERROR_SYSCALL: ERR_clear_error(); return Outcome::closed;
        default: break;
    }
    const unsigned long code = ERR_peek_last_error();
    if (ERR_GET_LIB(code) == ERR_LIB_SSL && ERR_GET_REASON(code) == SSL_R_UNEXPECTED_EOF_WHILE_READING) {
        ERR_clear_error();
        return Outcome::closed;
    }
    problem_ = take_tls_error();
    if (const long verified = SSL_get_verify_result(ssl_.get()); verified != X509_V_OK) {
        problem_ += std::string(": ") + X509_verify_cert_error_string(verified);
    }
    return Outcome::failed;
}

TlsStream::Outcome TlsStream::handshake() {
    ERR_clear_error();
    return outcome_of(SSL_do_handshake(ssl_.get()));
}

TlsStream::Outcome TlsStream::read(std::span<std::uint8_t> bytes, std::size_t& received) {
    ERR_clear_error();
    received = 0;
    return outcome_of(SSL_read_ex(ssl_.get(), bytes.data(), bytes.size(), &received));
}

TlsStream::Outcome TlsStream::write(std::span<const std::uint8_t> bytes, std::size_t& sent) {
    ERR_clear_error();
    sent = 0;
    return outcome_of(SSL_write_ex(ssl_.get(), bytes.data(), std::min(bytes.size(), record_bytes), &sent));
}

void TlsStream::end_output() noexcept {
    ERR_clear_error();
    if (SSL_is_init_finished(ssl_.get()) == 1) {
        SSL_shutdown(ssl_.get());
    }
    ERR_clear_error();
}

void TlsStream::leave_socket() noexcept {
    set_socket(SSL_get_rbio(ssl_.get()), -1);
}

bool TlsStream::would_be_taken_by(const TlsContext& context) const {
    if (SSL_get_SSL_CTX(ssl_.get()) == context.get()) {
        return true;  // the handshake was made with it
    }
    ERR_clear_error();
    const std::unique_ptr<X509, decltype(&X509_free)> certificate(SSL_get1_peer_certificate(ssl_.get()), X509_free);
    const std::unique_ptr<X509_STORE_CTX, decltype(&X509_STORE_CTX_free)> check(X509_STORE_CTX_new(),
                                                                                X509_STORE_CTX_free);
    const bool taken = certificate && check &&
                       X509_STORE_CTX_init(check.get(), SSL_CTX_get_cert_store(context.get()), certificate.get(),
                                           SSL_get_peer_cert_chain(ssl_.get())) == 1 &&
                       X509_STORE_CTX_set_default(check.get(), "ssl_client") == 1 && X509_verify_cert(check.get()) == 1;
    ERR_clear_error();
    return taken;
}

std::optional<std::string> TlsStream::peer_name() const {
    const std::unique_ptr<X509, decltype(&X509_free)> certificate(SSL_get1_peer_certificate(ssl_.get()), X509_free);
    if (!certificate) {
        return std::nullopt;
    }
    X509_NAME* const subject = X509_get_subject_name(certificate.get());
    const int place = X509_NAME_get_index_by_NID(subject, NID_commonName, -1);
    if (place < 0) {
        return std::string();
    }
    unsigned char* text = nullptr;
    const int length = ASN1_STRING_to_UTF8(&text, X509_NAME_ENTRY_get_data(X509_NAME_get_entry(subject, place)));
    if (length < 0) {
        return std::string();
    }
    std::string name(reinterpret_cast<const char*>(text), static_cast<std::size_t>(length));
    OPENSSL_free(text);
    return name;
}

}  // namespace disparityd::proto
