// SPDX-License-Identifier: Apache-2.0
#include "tests/vm/camera/command_socket.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include <sys/socket.h>
#include <sys/un.h>

namespace simulated_camera {

namespace {

sockaddr_un address_of(const std::string& path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (path.size() >= sizeof address.sun_path) {
        throw std::runtime_error(path + ": too long for a socket");
    }
    std::copy(path.begin(), path.end(), address.sun_path);
    return address;
}

FileDescriptor packet_socket() {
    return FileDescriptor(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0));
}

std::string receive_packet(int socket) {
    std::array<char, 4096> packet;
    const ssize_t length = ::recv(socket, packet.data(), packet.size(), 0);
    return {packet.data(), static_cast<std::size_t>(std::max<ssize_t>(length, 0))};
}

void send_packet(int socket, const std::string& packet) {
    // Who has gone does not want it.
    [[maybe_unused]] const ssize_t sent = ::send(socket, packet.data(), packet.size(), MSG_NOSIGNAL);
}

}  // namespace

CommandSocket::CommandSocket(const std::string& path) : listener_(packet_socket()) {
    const sockaddr_un address = address_of(path);
    ::unlink(path.c_str());
    if (::bind(listener_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
        ::listen(listener_.get(), 8) != 0) {
        throw std::runtime_error(path + ": cannot listen there");
    }
}

void CommandSocket::serve(const std::function<std::string(const std::string&)>& carry_out) {
    const FileDescriptor connection(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC));
    if (connection) {
        send_packet(connection.get(), carry_out(receive_packet(connection.get())));
    }
}

std::string send_command(const std::string& path, const std::string& command) {
    const FileDescriptor connection = packet_socket();
    const sockaddr_un address = address_of(path);
    if (::connect(connection.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
        return "error: " + path + ": no camera listens there";
    }
    send_packet(connection.get(), command);
    return receive_packet(connection.get());
}

}  // namespace simulated_camera
