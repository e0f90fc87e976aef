// SPDX-License-Identifier: Apache-2.0
#include "tests/daemon/abuse_fixture.h"

#include <algorithm>
#include <csignal>

#include <gmock/gmock.h>

namespace disparityd::test {

using std::chrono::steady_clock;
using ::testing::HasSubstr;
using namespace std::chrono_literals;

namespace {

// Sanitizers keep freed memory for a while to find its late users: 256 MiB of it, and their own notes.
#if defined(DISPARITYD_SANITIZED)
constexpr double growth_limit_mib = 640.0;
#else
constexpr double growth_limit_mib = 32.0;
#endif

}  // namespace

std::unique_ptr<DaemonProcess> AbuseTest::abuser(const std::string& manner, const std::string& address) {
    return std::make_unique<DaemonProcess>(folder_, std::vector<std::string>{manner, address},
                                           DaemonProcess::Environment{}, DISPARITYD_ABUSER);
}

void AbuseTest::run(const std::string& config, std::chrono::seconds duration) {
    const auto daemon = start_ready(config, {"--set", "socket.client_queue=8", "--set", "socket.max_clients=96"});
    const std::string tcp = daemon->address("tcp:");
    const std::string local = daemon->address("unix:");
    WireClient good_tcp = subscriber(tcp, {v1::DISPARITY, v1::CONFIDENCE}, "good over tcp");
    WireClient good_local = subscriber(local, {v1::DISPARITY, v1::LEFT}, "good over unix");
    ASSERT_TRUE(good_tcp.receive_frame());

    std::vector<std::unique_ptr<DaemonProcess>> abusers;
    // First the one whose line could be left out for the flood of the others.
    abusers.push_back(abuser("huge", tcp));
    ASSERT_TRUE(daemon->wait_for_log("4294967295 bytes announced")) << daemon->log();
    for (const char* manner : {"stop-reading", "random", "crowd"}) {
        abusers.push_back(abuser(manner, tcp));
    }
    abusers.push_back(abuser("stop-reading", local));
    auto victim = abuser("read", tcp);

    const std::string left_out = "lines of this kind left out before";
    std::uint64_t frames = 0;
    std::uint64_t killed = 0;
    double early_memory = 0;
    std::vector<std::uint64_t> last(2, 0);
    const auto begin = steady_clock::now();
    // As long as a slow machine needs for what is looked at below.
    const auto all_was_tried = [&] {
        return steady_clock::now() - begin >= duration && killed >= 3 && early_memory > 0 &&
               daemon->log().find(left_out) != std::string::npos;
    };
    while (!all_was_tried() && steady_clock::now() - begin < duration + DaemonProcess::patience) {
        for (WireClient* client : {&good_tcp, &good_local}) {
            const auto message = client->receive_frame();
            ASSERT_TRUE(message) << daemon->log();
            const v1::Frame& frame = message->envelope.frame();
            auto& before = last[client == &good_tcp ? 0 : 1];
            if (before != 0) {
                ASSERT_EQ(frame.publish_index(), before + 1);
                ASSERT_EQ(frame.skipped(), 0U);
            }
            before = frame.publish_index();
        }
        if (++frames % 5 == 0) {
            victim->send_signal(SIGKILL);
            ASSERT_EQ(victim->wait_for_exit(), 128 + SIGKILL) << victim->log();
            victim = abuser("read", killed++ % 2 == 0 ? local : tcp);
        }
        if (early_memory == 0 && steady_clock::now() - begin > duration / 2) {
            early_memory = daemon->peak_memory_mib();
        }
    }
    EXPECT_GE(killed, 3U);
    EXPECT_LT(daemon->peak_memory_mib() - early_memory, growth_limit_mib);
    const v1::Status now = status(good_tcp);
    EXPECT_EQ(now.state(), "running");
    EXPECT_EQ(std::count_if(now.clients().begin(), now.clients().end(),
                            [](const auto& client) { return client.name() == "stops reading"; }),
              2);
    RecordProperty("frames", std::to_string(frames));
    RecordProperty("dropped", std::to_string(now.dropped()));
    const std::string log = daemon->log();
    EXPECT_THAT(log, HasSubstr(left_out));
    EXPECT_LT(log.size(), 1U << 20) << "the log is not bounded";
    for (const auto& process : abusers) {
        EXPECT_EQ(process->wait_for_exit(0ms), std::nullopt) << process->log();
    }
    abusers.clear();
    daemon->send_signal(SIGTERM);
    EXPECT_EQ(daemon->wait_for_exit(), 0);
}

}  // namespace disparityd::test
