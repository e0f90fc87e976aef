// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "proto/framing.h"

/// The server's end of a connection, blocking. Made to say whatever a test wants, right or wrong.
class ServerEnd {
public:
    explicit ServerEnd(int fd) : fd_(fd) {}

    /// False when the client has closed.
    bool receive(disparityd::v1::Envelope& envelope);
    void send(const disparityd::v1::Envelope& envelope, std::span<const std::uint8_t> payload = {});
    void send_bytes(std::span<const std::uint8_t> bytes);

    /// Ends the connection before the script ends.
    void close();

    /// Hello, Welcome. The first message of the client is returned.
    disparityd::v1::Envelope greet(std::uint32_t version = disparityd::proto::protocol_version);
    /// The same, as a daemon that sends frames against credit and answers questions about its clock.
    disparityd::v1::Envelope greet_with_clock();

    /// Whether something comes within the time; also the client's end.
    bool hears(std::chrono::milliseconds timeout) const;

private:
    disparityd::v1::Envelope greet(std::uint32_t version, std::int64_t clock_ns);

    int fd_;
};

/// Listens on a Unix socket and on TCP (loopback, a port of the system's choice) and runs a script for each connection,
/// one after the other, in a thread of its own per address.
class FakeDaemon {
public:
    using Script = std::function<void(ServerEnd&)>;

    explicit FakeDaemon(Script script);
    ~FakeDaemon();
    FakeDaemon(const FakeDaemon&) = delete;
    FakeDaemon& operator=(const FakeDaemon&) = delete;

    std::string unix_address() const { return "unix:" + path_; }
    std::string tcp_address() const { return "tcp:127.0.0.1:" + std::to_string(port_); }

private:
    void serve(int listener);

    Script script_;
    std::string path_;
    int port_ = 0;
    int unix_fd_ = -1;
    int tcp_fd_ = -1;
    std::thread unix_thread_;
    std::thread tcp_thread_;
};
