// SPDX-License-Identifier: Apache-2.0
#include "tests/proto/fake_daemon.h"

#include <atomic>
#include <cstring>
#include <stdexcept>

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "proto/monotonic_clock.h"

namespace proto = disparityd::proto;
namespace v1 = disparityd::v1;

namespace {

bool receive_all(int fd, std::span<std::uint8_t> bytes) {
    while (!bytes.empty()) {
        const ssize_t got = ::recv(fd, bytes.data(), bytes.size(), 0);
        if (got <= 0) {
            return false;
        }
        bytes = bytes.subspan(static_cast<std::size_t>(got));
    }
    return true;
}

void require(bool condition, const char* what) {
    if (!condition) {
        throw std::runtime_error(std::string("fake daemon: ") + what);
    }
}

std::string new_path() {
    static std::atomic<int> count{0};
    return "/tmp/disparityd-test-" + std::to_string(::getpid()) + "-" + std::to_string(count++);
}

}  // namespace

bool ServerEnd::receive(v1::Envelope& envelope) {
    std::uint8_t length[proto::length_bytes];
    if (!receive_all(fd_, length)) {
        return false;
    }
    std::vector<std::uint8_t> bytes(proto::decode_length(length));
    if (!receive_all(fd_, bytes)) {
        return false;
    }
    proto::decode(bytes, envelope);
    return true;
}

void ServerEnd::send(const v1::Envelope& envelope, std::span<const std::uint8_t> payload) {
    std::vector<std::uint8_t> bytes;
    proto::encode(envelope, bytes);
    send_bytes(bytes);
    send_bytes(payload);
}

void ServerEnd::send_bytes(std::span<const std::uint8_t> bytes) {
    while (!bytes.empty()) {
        const ssize_t sent = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
        if (sent <= 0) {
            return;  // the client has left; it has seen what the test wanted
        }
        bytes = bytes.subspan(static_cast<std::size_t>(sent));
    }
}

void ServerEnd::close() {
    ::shutdown(fd_, SHUT_RDWR);
}

v1::Envelope ServerEnd::greet(std::uint32_t version) {
    return greet(version, 0);
}

v1::Envelope ServerEnd::greet_with_clock() {
    return greet(proto::protocol_version, proto::monotonic_ns());
}

bool ServerEnd::hears(std::chrono::milliseconds timeout) const {
    pollfd entry{fd_, POLLIN, 0};
    return ::poll(&entry, 1, static_cast<int>(timeout.count())) > 0;
}

v1::Envelope ServerEnd::greet(std::uint32_t version, std::int64_t clock_ns) {
    v1::Envelope hello;
    receive(hello);
    v1::Envelope answer;
    answer.mutable_welcome()->set_protocol_version(version);
    answer.mutable_welcome()->set_server_version("fake");
    answer.mutable_welcome()->set_monotonic_ns(clock_ns);
    send(answer);
    return hello;
}

FakeDaemon::FakeDaemon(Script script) : script_(std::move(script)), path_(new_path()) {
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    std::memcpy(name.sun_path, path_.c_str(), path_.size() + 1);
    unix_fd_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    require(::bind(unix_fd_, reinterpret_cast<sockaddr*>(&name), sizeof name) == 0, "bind unix");
    require(::listen(unix_fd_, 8) == 0, "listen unix");

    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    tcp_fd_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    require(::bind(tcp_fd_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0, "bind tcp");
    require(::listen(tcp_fd_, 8) == 0, "listen tcp");
    require(::getsockname(tcp_fd_, reinterpret_cast<sockaddr*>(&address), &size) == 0, "getsockname");
    port_ = ntohs(address.sin_port);

    unix_thread_ = std::thread([this] { serve(unix_fd_); });
    tcp_thread_ = std::thread([this] { serve(tcp_fd_); });
}

FakeDaemon::~FakeDaemon() {
    ::shutdown(unix_fd_, SHUT_RDWR);
    ::shutdown(tcp_fd_, SHUT_RDWR);
    unix_thread_.join();
    tcp_thread_.join();
    ::close(unix_fd_);
    ::close(tcp_fd_);
    ::unlink(path_.c_str());
}

void FakeDaemon::serve(int listener) {
    while (true) {
        const int fd = ::accept4(listener, nullptr, nullptr, SOCK_CLOEXEC);
        if (fd < 0) {
            return;
        }
        ServerEnd end(fd);
        script_(end);
        ::close(fd);
    }
}
