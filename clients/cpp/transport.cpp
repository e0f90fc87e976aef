// SPDX-License-Identifier: Apache-2.0
#include "clients/cpp/transport.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <memory>
#include <stdexcept>

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "proto/monotonic_clock.h"

namespace disparity {
namespace {

using TlsStream = disparityd::proto::TlsStream;

/// Returns milliseconds for poll(), rounded up: rounded down, the caller would spin before the deadline.
int remaining(Deadline deadline) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now()).count();
    return static_cast<int>(std::clamp<std::int64_t>(left, 0, 1'000'000'000));
}

/// Returns false when the time is up. An error of the socket counts as ready: the next call on it reports the error.
bool wait_for(int fd, short events, Deadline deadline) {
    while (true) {
        pollfd entry{fd, events, 0};
        const int result = ::poll(&entry, 1, remaining(deadline));
        if (result > 0) {
            return true;
        }
        if (result == 0 && std::chrono::steady_clock::now() >= deadline) {
            return false;
        }
        if (result < 0 && errno != EINTR) {
            return true;
        }
    }
}

/// Returns a connected descriptor, or -1 and errno.
int connect_one(int family, const sockaddr* address, socklen_t length, Deadline deadline) {
    const int fd = ::socket(family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (fd < 0) {
        return -1;
    }
    int error = ::connect(fd, address, length) == 0 ? 0 : errno;
    if (error == EINPROGRESS || error == EINTR) {
        error = ETIMEDOUT;
        if (wait_for(fd, POLLOUT, deadline)) {
            socklen_t size = sizeof error;
            if (::getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &size) != 0) {
                error = errno;
            }
        }
    }
    if (error != 0) {
        ::close(fd);
        errno = error;
        return -1;
    }
    return fd;
}

[[noreturn]] void no_connection(const std::string& address, int error, const char* reason = nullptr) {
    if (error == EMFILE || error == ENFILE) {
        throw std::runtime_error(address + ": cannot connect: " +
                                 (error == EMFILE ? "this program has too many files open: raise its limit (ulimit -n, "
                                                    "or LimitNOFILE= of a service)"
                                                  : "all programs together have too many files open: raise the limit "
                                                    "(sysctl fs.file-max)"));
    }
    throw std::runtime_error(address + ": cannot connect: " + (reason == nullptr ? std::strerror(error) : reason) +
                             ": is disparityd running, with this address?");
}

int connect_unix(const std::string& address, const std::string& path, Deadline deadline) {
    sockaddr_un name{};
    if (path.empty() || path.size() >= sizeof name.sun_path) {
        throw std::invalid_argument(address + ": a path of 1 to " + std::to_string(sizeof name.sun_path - 1) +
                                    " characters is allowed after unix:");
    }
    name.sun_family = AF_UNIX;
    std::memcpy(name.sun_path, path.c_str(), path.size() + 1);
    const int fd = connect_one(AF_UNIX, reinterpret_cast<const sockaddr*>(&name), sizeof name, deadline);
    if (fd < 0) {
        no_connection(address, errno);
    }
    return fd;
}

/// The two parts of "tcp:HOST:PORT" and "tls:HOST:PORT"; IPv6 without its brackets.
struct Place {
    std::string host;
    std::string port;
};

Place place_of(const std::string& address) {
    const std::string host_and_port = address.substr(4);
    const std::size_t colon = host_and_port.rfind(':');
    if (colon == std::string::npos || colon == 0 || colon + 1 == host_and_port.size()) {
        throw std::invalid_argument(address + ": expected " + address.substr(0, 4) + "HOST:PORT");
    }
    const std::string port = host_and_port.substr(colon + 1);
    int number = 0;
    const auto [end, problem] = std::from_chars(port.data(), port.data() + port.size(), number);
    if (problem != std::errc() || end != port.data() + port.size() || number < 1 || number > 65535) {
        throw std::invalid_argument(address + ": port: found " + port + ", allowed: 1 .. 65535");
    }
    std::string host = host_and_port.substr(0, colon);
    if (host.size() > 2 && host.front() == '[' && host.back() == ']') {
        host = host.substr(1, host.size() - 2);
    }
    return {host, port};
}

/// Takes "tcp://HOST:PORT" as "tcp:HOST:PORT": other programs write addresses so.
std::string without_slashes(const std::string& address) {
    const bool has_host = address.starts_with("tcp://") || address.starts_with("tls://");
    return has_host ? address.substr(0, 4) + address.substr(6) : address;
}

int connect_tcp(const std::string& address, const Place& place, Deadline deadline) {
    addrinfo hints{};
    hints.ai_family = AF_UNSPEC;
    hints.ai_socktype = SOCK_STREAM;
    addrinfo* found = nullptr;
    const int result = ::getaddrinfo(place.host.c_str(), place.port.c_str(), &hints, &found);
    if (result != 0) {
        no_connection(address, result == EAI_SYSTEM ? errno : 0,
                      result == EAI_SYSTEM ? nullptr : ::gai_strerror(result));
    }
    const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owner(found, &::freeaddrinfo);
    int error = 0;
    for (const addrinfo* entry = found; entry != nullptr; entry = entry->ai_next) {
        const int fd = connect_one(entry->ai_family, entry->ai_addr, entry->ai_addrlen, deadline);
        if (fd >= 0) {
            // A request is small, and its answer is waited for: sending must not be delayed.
            const int on = 1;
            ::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
            return fd;
        }
        error = errno;
    }
    no_connection(address, error);
}

constexpr const char* port_without_tls =
    ": that port speaks no TLS: the daemon needs [socket] certificate and key, or is reached at tcp:HOST:PORT";

/// Returns what a user may do about a handshake that failed.
std::string advice_on(const std::string& problem, const std::string& name) {
    const auto says = [&](const char* words) { return problem.find(words) != std::string::npos; };
    if (says("mismatch")) {
        return ": the certificate is not for " + name +
               ": connect by a name that it has, or say which one (server_name)";
    }
    if (says("not yet valid") || says("expired")) {
        return ": is the clock of this machine right?";
    }
    if (says("purpose")) {
        return ": the daemon shows a certificate that is not for a server: its [socket] certificate must be another "
               "one";
    }
    if (says("certificate verify failed")) {
        return ": the daemon's certificate is signed by nobody who is trusted: give its authority's file";
    }
    if (says("wrong version number") || says("packet length") || says("record layer failure")) {
        return port_without_tls;
    }
    return "";
}

bool is_loopback(const sockaddr_storage& peer) {
    if (peer.ss_family == AF_INET) {
        const auto& address = reinterpret_cast<const sockaddr_in&>(peer);
        return ntohl(address.sin_addr.s_addr) >> 24U == 127;
    }
    if (peer.ss_family == AF_INET6) {
        const in6_addr& address = reinterpret_cast<const sockaddr_in6&>(peer).sin6_addr;
        return IN6_IS_ADDR_LOOPBACK(&address) != 0 ||
               (IN6_IS_ADDR_V4MAPPED(&address) != 0 && address.s6_addr[12] == 127);
    }
    return peer.ss_family == AF_UNIX;
}

}  // namespace

Deadline after(std::chrono::milliseconds timeout) {
    using std::chrono::milliseconds;
    const milliseconds longest = std::chrono::hours(24 * 365);
    return std::chrono::steady_clock::now() + std::clamp(timeout, milliseconds(0), longest);
}

Transport::Transport(const std::string& given, Deadline deadline, const ConnectOptions& options) {
    const std::string address = without_slashes(given);
    if (address.starts_with("unix:")) {
        fd_ = connect_unix(address, address.substr(5), deadline);
    } else if (address.starts_with("tcp:")) {
        fd_ = connect_tcp(address, place_of(address), deadline);
    } else if (address.starts_with("tls:")) {
        try {
            begin_tls(address, deadline, options);
        } catch (...) {
            close();
            throw;
        }
    } else {
        throw std::invalid_argument("address \"" + address + "\": expected tcp:HOST:PORT, tls:HOST:PORT or unix:PATH");
    }
}

void Transport::begin_tls(const std::string& address, Deadline deadline, const ConnectOptions& options) {
    const Place place = place_of(address);
    const auto context = disparityd::proto::make_client_tls({options.certificate, options.key, options.authority});
    fd_ = connect_tcp(address, place, deadline);
    tls_ = std::make_unique<TlsStream>(context, fd_, TlsStream::End::client);
    const std::string& name = options.server_name.empty() ? place.host : options.server_name;
    tls_->expect_server(name);
    while (true) {
        const TlsStream::Outcome outcome = tls_->handshake();
        switch (outcome) {
            case TlsStream::Outcome::done: return;
            case TlsStream::Outcome::closed:
                throw std::runtime_error(address + ": cannot connect: closed during the TLS handshake" +
                                         port_without_tls);
            case TlsStream::Outcome::failed:
                throw std::runtime_error(address + ": cannot connect: TLS: " + tls_->problem() +
                                         advice_on(tls_->problem(), name));
            default: break;
        }
        if (!wait(outcome, deadline)) {
            throw std::runtime_error(address + ": cannot connect: no TLS handshake in time");
        }
    }
}

bool Transport::wait(TlsStream::Outcome outcome, Deadline deadline) const {
    return wait_for(fd_, outcome == TlsStream::Outcome::wants_write ? POLLOUT : POLLIN, deadline);
}

bool Transport::is_private() const {
    sockaddr_storage peer{};
    socklen_t size = sizeof peer;
    return tls_ || (::getpeername(fd_, reinterpret_cast<sockaddr*>(&peer), &size) == 0 && is_loopback(peer));
}

Transport::~Transport() {
    close();
}

void Transport::close() {
    if (fd_ >= 0) {
        ::close(fd_);
        fd_ = -1;
    }
}

std::optional<unsigned> Transport::server_user() const {
    int domain = 0;
    socklen_t size = sizeof domain;
    if (::getsockopt(fd_, SOL_SOCKET, SO_DOMAIN, &domain, &size) != 0 || domain != AF_UNIX) {
        return std::nullopt;
    }
    ucred peer{};
    size = sizeof peer;
    if (::getsockopt(fd_, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) {
        return std::nullopt;
    }
    return peer.uid;
}

/// Returns what a call that cannot go on comes to.
Transport::Outcome Transport::end_of(TlsStream::Outcome outcome) {
    if (outcome == TlsStream::Outcome::done) {
        return Outcome::done;
    }
    if (outcome == TlsStream::Outcome::failed) {
        const auto says = [&](const char* word) { return tls_->problem().find(word) != std::string::npos; };
        why_closed_ = "TLS: " + tls_->problem();
        if (says("revoked")) {
            why_closed_ += ": whoever runs the daemon has taken this certificate back";
        } else if (says("unsupported certificate")) {
            why_closed_ += ": this certificate is for another purpose than a client's: have one made for a client";
        } else if (says("certificate")) {
            why_closed_ += ": the daemon takes only clients with a certificate that its authority has signed";
        }
    }
    return Outcome::closed;
}

Transport::Outcome Transport::send_tls(std::span<const std::uint8_t> bytes, Deadline deadline) {
    while (!bytes.empty()) {
        std::size_t sent = 0;
        const TlsStream::Outcome outcome = tls_->write(bytes, sent);
        bytes = bytes.subspan(sent);
        if (TlsStream::is_wanting(outcome)) {
            if (!wait(outcome, deadline)) {
                return Outcome::timeout;
            }
        } else if (outcome != TlsStream::Outcome::done) {
            return end_of(outcome);
        }
    }
    return Outcome::done;
}

Transport::Outcome Transport::receive_tls(std::span<std::uint8_t> bytes, std::size_t& received, Deadline deadline) {
    while (true) {
        const TlsStream::Outcome outcome = tls_->read(bytes, received);
        if (!TlsStream::is_wanting(outcome)) {
            heard_ns_ = disparityd::proto::monotonic_ns();
            return end_of(outcome);
        }
        empty_ns_ = disparityd::proto::monotonic_ns();
        if (!wait(outcome, deadline)) {
            return Outcome::timeout;
        }
    }
}

Transport::Outcome Transport::send(std::span<const std::uint8_t> bytes, Deadline deadline) {
    if (tls_ && fd_ >= 0) {
        return send_tls(bytes, deadline);
    }
    while (!bytes.empty()) {
        const ssize_t sent = fd_ < 0 ? -1 : ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
        if (sent >= 0) {
            bytes = bytes.subspan(static_cast<std::size_t>(sent));
        } else if (fd_ < 0 || (errno != EAGAIN && errno != EINTR)) {
            return Outcome::closed;
        } else if (!wait_for(fd_, POLLOUT, deadline)) {
            return Outcome::timeout;
        }
    }
    return Outcome::done;
}

Transport::Outcome Transport::receive(std::span<std::uint8_t> bytes, std::size_t& received, Deadline deadline) {
    received = 0;
    if (tls_ && fd_ >= 0) {
        return receive_tls(bytes, received, deadline);
    }
    while (fd_ >= 0) {
        const ssize_t got = ::recv(fd_, bytes.data(), bytes.size(), 0);
        if (got > 0) {
            received = static_cast<std::size_t>(got);
            heard_ns_ = disparityd::proto::monotonic_ns();
            return Outcome::done;
        }
        if (got == 0 || (errno != EAGAIN && errno != EINTR)) {
            return Outcome::closed;
        }
        empty_ns_ = disparityd::proto::monotonic_ns();
        if (!wait_for(fd_, POLLIN, deadline)) {
            return Outcome::timeout;
        }
    }
    return Outcome::closed;
}

}  // namespace disparity
