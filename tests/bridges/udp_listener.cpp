// SPDX-License-Identifier: Apache-2.0
#include "tests/bridges/udp_listener.h"

#include <stdexcept>

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace disparityd::test {

UdpListener::UdpListener(std::uint16_t port) : fd_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(port);
    socklen_t size = sizeof address;
    auto* const generic = reinterpret_cast<sockaddr*>(&address);
    if (::bind(fd_, generic, sizeof address) != 0 || ::getsockname(fd_, generic, &size) != 0) {
        ::close(fd_);
        throw std::runtime_error("no port " + std::to_string(port));
    }
    port_ = ntohs(address.sin_port);
}

UdpListener::~UdpListener() {
    ::close(fd_);
}

std::optional<std::vector<std::uint8_t>> UdpListener::receive(std::chrono::milliseconds timeout) {
    pollfd waiting{fd_, POLLIN, 0};
    if (::poll(&waiting, 1, static_cast<int>(timeout.count())) <= 0) {
        return std::nullopt;
    }
    std::vector<std::uint8_t> bytes(65536);
    sender_.resize(sizeof(sockaddr_in));
    socklen_t size = sizeof(sockaddr_in);
    const ssize_t got =
        ::recvfrom(fd_, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(sender_.data()), &size);
    if (got < 0) {
        return std::nullopt;
    }
    bytes.resize(static_cast<std::size_t>(got));
    return bytes;
}

void UdpListener::answer(const std::vector<std::uint8_t>& bytes) {
    static_cast<void>(::sendto(fd_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(sender_.data()),
                               static_cast<socklen_t>(sender_.size())));
}

}  // namespace disparityd::test
