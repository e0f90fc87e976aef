// SPDX-License-Identifier: Apache-2.0
#include "tests/bridges/ros2/loopback.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace disparityd::test {

bool loopback_carries_datagrams() {
    const int fd = ::socket(AF_INET, SOCK_DGRAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* const generic = reinterpret_cast<sockaddr*>(&address);
    const bool sent = ::bind(fd, generic, size) == 0 && ::getsockname(fd, generic, &size) == 0 &&
                      ::sendto(fd, "x", 1, 0, generic, size) == 1;
    pollfd waiting{fd, POLLIN, 0};
    const bool came = sent && ::poll(&waiting, 1, 1000) == 1;
    ::close(fd);
    return came;
}

}  // namespace disparityd::test
