// SPDX-License-Identifier: Apache-2.0
//
// soak_wire ADDRESS MANNER: a client on a bare socket, which checks what the daemon counts for it.
//   account  reads frames until the standard input ends, and compares its counts with those of the daemon's status
//   slow     the same, but reads nothing between the first frame and the end
//   torn     sends half a message, and waits to be killed
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <string>
#include <thread>

#include <poll.h>
#include <unistd.h>

#include "tests/daemon/wire_client.h"
#include "tests/soak/reader_account.h"

namespace disparityd::test {
namespace {

/// What this client got: it reads everything that was sent to it.
struct Counts {
    ReaderAccount account;
    std::uint64_t skipped = 0;  ///< as the frames say

    void add(const v1::Frame& frame) {
        skipped += frame.skipped();
        account.add({frame.publish_index(), frame.sequence(), frame.dropped_before(), frame.skipped(), frame.age_ns(),
                     (frame.flags() & v1::DISCONTINUITY) != 0});
    }
};

/// The next message, or one line why there is none.
v1::Envelope next_message(WireClient& client) {
    auto message = client.receive(longest_wait);
    if (!message) {
        throw std::runtime_error("no message for " + std::to_string(longest_wait.count()) + " s");
    }
    if (message->envelope.has_error()) {
        throw std::runtime_error("refused: " + message->envelope.error().message());
    }
    return std::move(message->envelope);
}

void read_frame(WireClient& client, Counts& counts) {
    for (;;) {
        const v1::Envelope message = next_message(client);
        if (message.has_frame()) {
            counts.add(message.frame());
            return;
        }
    }
}

/// Ends the subscription and asks for the status. What comes before that is read, too.
v1::Status end_subscription(WireClient& client, Counts& counts) {
    client.send(subscription({}));
    v1::Envelope request;
    request.mutable_status_request();
    client.send(request);
    for (;;) {
        const v1::Envelope message = next_message(client);
        if (message.has_frame()) {
            counts.add(message.frame());
        } else if (message.has_status()) {
            return message.status();
        }
    }
}

/// Compares with what the daemon has counted for the client of this name.
void compare(const v1::Status& status, const std::string& name, const Counts& counts) {
    for (const v1::ClientStatus& client : status.clients()) {
        if (client.name() == name) {
            if (client.frames_sent() != counts.account.frames() || client.frames_skipped() != counts.skipped) {
                throw std::logic_error("the daemon counts " + std::to_string(client.frames_sent()) +
                                       " frames sent and " + std::to_string(client.frames_skipped()) +
                                       " skipped, here were " + std::to_string(counts.account.frames()) + " and " +
                                       std::to_string(counts.skipped));
            }
            return;
        }
    }
    throw std::logic_error("the status does not know the client " + name);
}

void wait_until_asked_to_end() {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    poll(&input, 1, -1);
}

void run(const std::string& address, const std::string& manner) {
    const std::string name = "soak " + manner + ' ' + std::to_string(getpid());
    WireClient client(address);
    const auto welcome = client.hello(name);
    if (!welcome || !welcome->has_welcome()) {
        throw std::runtime_error("no welcome");
    }
    client.send(subscription({v1::DISPARITY, v1::CONFIDENCE, v1::LEFT}));
    Counts counts;
    read_frame(client, counts);
    std::puts("frame");
    std::fflush(stdout);
    if (manner == "torn") {
        client.send_bytes(std::vector<std::uint8_t>{200, 0, 0, 0, 10, 20});
        wait_until_asked_to_end();
        return;
    }
    if (manner == "slow") {
        wait_until_asked_to_end();
    }
    while (!asked_to_end()) {
        read_frame(client, counts);
    }
    read_frame(client, counts);
    const v1::Status status = end_subscription(client, counts);
    compare(status, name, counts);
    std::printf("%s\n", counts.account.to_json().c_str());
}

}  // namespace
}  // namespace disparityd::test

int main(int argc, char** argv) {
    const std::string manner = argc == 3 ? argv[2] : "";
    if (manner != "account" && manner != "slow" && manner != "torn") {
        std::fputs("usage: soak_wire tcp:HOST:PORT|unix:PATH account|slow|torn\n", stderr);
        return 2;
    }
    try {
        disparityd::test::run(argv[1], manner);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "soak_wire: error: %s\n", error.what());
        return 1;
    }
}
