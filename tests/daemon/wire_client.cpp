// SPDX-License-Identifier: Apache-2.0
#include "tests/daemon/wire_client.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "proto/framing.h"

namespace disparityd::test {
namespace {

using std::chrono::steady_clock;

int connect_unix(const std::string& path) {
    const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof(address.sun_path) - 1);
    return ::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0 ? fd : (::close(fd), -1);
}

int connect_tcp(const std::string& host, int port) {
    const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    const int on = 1;
    ::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
    inet_pton(AF_INET, host.c_str(), &address.sin_addr);
    return ::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0 ? fd : (::close(fd), -1);
}

bool wait_readable(int fd, steady_clock::time_point deadline) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - steady_clock::now());
    pollfd event{fd, POLLIN, 0};
    return ::poll(&event, 1, static_cast<int>(std::max<std::int64_t>(0, left.count()))) > 0;
}

}  // namespace

WireClient::WireClient(const std::string& address) {
    if (address.starts_with("unix:")) {
        fd_ = connect_unix(address.substr(5));
    } else {
        const auto colon = address.rfind(':');
        fd_ = connect_tcp(address.substr(4, colon - 4), std::stoi(address.substr(colon + 1)));
    }
    if (fd_ < 0) {
        throw std::runtime_error(address + ": " + std::strerror(errno));
    }
}

WireClient::~WireClient() {
    if (fd_ >= 0) {
        ::close(fd_);
    }
}

WireClient::WireClient(WireClient&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

WireClient& WireClient::operator=(WireClient&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
}

bool WireClient::send_bytes(std::span<const std::uint8_t> bytes) {
    while (!bytes.empty()) {
        const ssize_t sent = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
        if (sent <= 0) {
            return false;
        }
        bytes = bytes.subspan(static_cast<std::size_t>(sent));
    }
    return true;
}

bool WireClient::send(const v1::Envelope& message) {
    std::vector<std::uint8_t> bytes;
    proto::encode(message, bytes);
    return send_bytes(bytes);
}

std::optional<v1::Envelope> WireClient::hello(const std::string& name, const std::string& token) {
    v1::Envelope message;
    message.mutable_hello()->set_protocol_version(proto::protocol_version);
    message.mutable_hello()->set_client_name(name);
    message.mutable_hello()->set_token(token);
    send(message);
    const auto answer = receive();
    return answer ? std::optional(answer->envelope) : std::nullopt;
}

bool WireClient::record(const std::string& path) {
    v1::Envelope request;
    if (path.empty()) {
        request.mutable_record_stop();
    } else {
        request.mutable_record_start()->set_path(path);
    }
    const auto answer = send(request) ? receive() : std::nullopt;
    return answer && answer->envelope.has_record_status();
}

bool WireClient::receive_bytes(std::span<std::uint8_t> bytes, steady_clock::time_point deadline) {
    while (!bytes.empty()) {
        if (!wait_readable(fd_, deadline)) {
            return false;
        }
        const ssize_t got = ::recv(fd_, bytes.data(), bytes.size(), 0);
        if (got <= 0) {
            return false;
        }
        bytes = bytes.subspan(static_cast<std::size_t>(got));
    }
    return true;
}

std::optional<WireClient::Message> WireClient::receive(std::chrono::milliseconds timeout) {
    const auto deadline = steady_clock::now() + timeout;
    std::array<std::uint8_t, proto::length_bytes> length{};
    if (!receive_bytes(length, deadline)) {
        return std::nullopt;
    }
    std::vector<std::uint8_t> body(proto::decode_length(length));
    Message message;
    if (!receive_bytes(body, deadline)) {
        return std::nullopt;
    }
    proto::decode(body, message.envelope);
    message.payload.resize(message.envelope.payload_bytes());
    if (!receive_bytes(message.payload, deadline)) {
        return std::nullopt;
    }
    return message;
}

std::optional<WireClient::Message> WireClient::receive_frame(std::chrono::milliseconds timeout) {
    const auto deadline = steady_clock::now() + timeout;
    while (steady_clock::now() < deadline) {
        auto message = receive(std::chrono::ceil<std::chrono::milliseconds>(deadline - steady_clock::now()));
        if (!message || message->envelope.has_frame()) {
            return message;
        }
    }
    return std::nullopt;
}

std::string WireClient::receive_error(std::chrono::milliseconds timeout) {
    const auto deadline = steady_clock::now() + timeout;
    while (const auto message = receive(std::chrono::ceil<std::chrono::milliseconds>(deadline - steady_clock::now()))) {
        if (message->envelope.has_error()) {
            return message->envelope.error().message();
        }
    }
    return {};
}

bool WireClient::is_closed(std::chrono::milliseconds timeout) {
    const auto deadline = steady_clock::now() + timeout;
    std::array<std::uint8_t, 4096> ignored{};
    while (wait_readable(fd_, deadline)) {
        if (::recv(fd_, ignored.data(), ignored.size(), 0) <= 0) {
            return true;
        }
    }
    return false;
}

v1::Status status(WireClient& client) {
    v1::Envelope request;
    request.mutable_status_request();
    client.send(request);
    while (const auto answer = client.receive()) {
        if (answer->envelope.has_status()) {
            return answer->envelope.status();
        }
    }
    throw std::runtime_error("the daemon has not said its status");
}

v1::Envelope subscription(const std::vector<v1::Product>& products) {
    v1::Envelope message;
    message.mutable_subscribe();
    for (const v1::Product product : products) {
        message.mutable_subscribe()->add_products(product);
    }
    return message;
}

}  // namespace disparityd::test
