// SPDX-License-Identifier: Apache-2.0
//
// A client that misbehaves, as a process of its own so that it can be killed: abuser MANNER ADDRESS.
#include <array>
#include <chrono>
#include <cstdio>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <sys/socket.h>

#include "tests/daemon/wire_client.h"

namespace disparityd::test {
namespace {

/// Subscribes to everything and never reads again.
[[noreturn]] void stop_reading(const std::string& address) {
    WireClient client(address);
    client.hello("stops reading");
    client.send(subscription({v1::DISPARITY, v1::CONFIDENCE, v1::LEFT}));
    for (;;) {
        std::this_thread::sleep_for(std::chrono::seconds(1));
    }
}

/// Reads frames until it is killed.
[[noreturn]] void read_on(const std::string& address) {
    WireClient client(address);
    client.hello("to be killed");
    client.send(subscription({v1::DISPARITY, v1::LEFT}));
    while (client.receive_frame()) {
        std::printf("frame\n");
        std::fflush(stdout);
    }
    throw std::runtime_error("the daemon hung up");
}

[[noreturn]] void random_bytes(const std::string& address) {
    std::mt19937 random(1);
    for (;;) {
        WireClient client(address);
        std::vector<std::uint8_t> bytes(random() % 20000);
        for (auto& byte : bytes) {
            byte = static_cast<std::uint8_t>(random());
        }
        client.send_bytes(bytes);
        ::shutdown(client.descriptor(), SHUT_WR);
        client.is_closed(std::chrono::seconds(7));
    }
}

[[noreturn]] void huge_message(const std::string& address) {
    for (;;) {
        WireClient client(address);
        client.hello("huge");
        client.send_bytes(std::array<std::uint8_t, 8>{0xff, 0xff, 0xff, 0xff, 1, 2, 3, 4});
        client.receive_error();
        client.is_closed();
    }
}

/// Fifty at once that read everything, hang up and come back.
[[noreturn]] void crowd(const std::string& address) {
    for (;;) {
        std::vector<WireClient> clients;
        for (int i = 0; i < 50; ++i) {
            clients.emplace_back(address);
            clients.back().hello("crowd");
            clients.back().send(subscription({v1::DISPARITY}));
        }
        for (int round = 0; round < 10; ++round) {
            for (WireClient& client : clients) {
                client.receive_frame();
            }
        }
    }
}

}  // namespace
}  // namespace disparityd::test

int main(int argc, char** argv) {
    using namespace disparityd::test;
    const std::string manner = argc == 3 ? argv[1] : "";
    try {
        if (manner == "stop-reading") {
            stop_reading(argv[2]);
        } else if (manner == "read") {
            read_on(argv[2]);
        } else if (manner == "random") {
            random_bytes(argv[2]);
        } else if (manner == "huge") {
            huge_message(argv[2]);
        } else if (manner == "crowd") {
            crowd(argv[2]);
        }
        std::fprintf(stderr, "abuser: error: found manner \"%s\", allowed: stop-reading, read, random, huge, crowd\n",
                     manner.c_str());
        return 2;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "abuser: error: %s\n", error.what());
        return 1;
    }
}
