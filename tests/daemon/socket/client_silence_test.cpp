// SPDX-License-Identifier: Apache-2.0
//
// How long a client may be silent: one that waits for something as long as it likes, others and vanished ones not.
#include <array>
#include <cerrno>
#include <cstring>
#include <thread>

#include <gmock/gmock.h>
#include <linux/filter.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include "tests/daemon/socket/server_fixture.h"

namespace disparityd::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using namespace std::chrono_literals;

class ClientSilenceTest : public ServerTest {
protected:
    /// From now on nothing reaches it, and nothing is acknowledged: as if its machine had lost its power.
    static void cut_off(const WireClient& client) {
        std::array<sock_filter, 1> nothing{{{BPF_RET | BPF_K, 0, 0, 0}}};
        const sock_fprog program{nothing.size(), nothing.data()};
        ASSERT_EQ(::setsockopt(client.descriptor(), SOL_SOCKET, SO_ATTACH_FILTER, &program, sizeof(program)), 0)
            << std::strerror(errno);
    }

    static bool system_tells_of_connections() {
        const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
        tcp_info info{};
        socklen_t size = sizeof(info);
        const bool tells = ::getsockopt(socket, IPPROTO_TCP, TCP_INFO, &info, &size) == 0 && size > sizeof(int);
        ::close(socket);
        return tells;
    }

    int clients(WireClient& observer) { return status(observer).clients_size(); }

    /// Until there are so many.
    bool wait_for_clients(WireClient& observer, int wanted) {
        const auto end = std::chrono::steady_clock::now() + 60s;
        while (clients(observer) != wanted && std::chrono::steady_clock::now() < end) {
            std::this_thread::sleep_for(20ms);
        }
        return clients(observer) == wanted;
    }
};

TEST_F(ClientSilenceTest, OneThatWaitsForNothingIsClosed) {
    config_.idle_timeout = 500ms;
    start();
    for (const std::string& address : {tcp_, unix_}) {
        const auto begin = std::chrono::steady_clock::now();
        WireClient client = connect(address);
        const auto end = client.receive();
        ASSERT_TRUE(end && end->envelope.has_error());
        EXPECT_TRUE(end->envelope.error().closing());
        EXPECT_THAT(end->envelope.error().message(),
                    AllOf(HasSubstr("nothing was asked for 0.5 s"), HasSubstr("[socket] idle_timeout_s")));
        EXPECT_GE(std::chrono::steady_clock::now() - begin, config_.idle_timeout);
        EXPECT_TRUE(client.is_closed());
    }
}

TEST_F(ClientSilenceTest, HalfAMessageIsNoQuestion) {
    config_.idle_timeout = 500ms;
    start();
    WireClient client = connect(tcp_);
    ASSERT_TRUE(client.send_bytes(std::array<std::uint8_t, 2>{9, 0}));
    EXPECT_THAT(client.receive_error(), HasSubstr("nothing was asked"));
}

TEST_F(ClientSilenceTest, WhoeverWaitsForSomethingStays) {
    start();
    WireClient frames = connect(tcp_, "frames");
    subscribe(frames, subscription({v1::DISPARITY}));
    WireClient samples = connect(tcp_, "samples");
    v1::Envelope request;
    request.mutable_subscribe()->set_sensors(true);
    subscribe(samples, request);
    WireClient watcher = connect(tcp_, "watcher");
    request.Clear();
    request.mutable_subscribe()->set_status_interval_s(3600);
    subscribe(watcher, request);
    recording_.store(true);
    WireClient records = connect(unix_, "records");
    request.Clear();
    request.mutable_record_start()->set_path("a.mkv");
    ASSERT_TRUE(records.send(request));
    ASSERT_TRUE(records.receive());
    // Not before all of them wait for something, however long that took.
    config_.idle_timeout = 500ms;
    server_->reconfigure(config_);
    WireClient idle = connect(tcp_, "idle");
    EXPECT_THAT(idle.receive_error(), HasSubstr("nothing was asked"));
    ASSERT_TRUE(wait_for_clients(watcher, 4));
    const auto end = std::chrono::steady_clock::now() + 4 * config_.idle_timeout;
    while (std::chrono::steady_clock::now() < end) {
        EXPECT_EQ(clients(watcher), 4);
        std::this_thread::sleep_for(50ms);
    }
    recording_.store(false);
    EXPECT_THAT(records.receive_error(), HasSubstr("nothing was asked"));
    ASSERT_TRUE(frames.send(subscription({})));
    EXPECT_THAT(frames.receive_error(), HasSubstr("nothing was asked"));
}

TEST_F(ClientSilenceTest, NoTimeoutIsForEver) {
    config_.idle_timeout = 0ms;
    config_.liveness = {1s, 1s, 1};  // clients are looked at often
    start();
    WireClient client = connect(tcp_);
    EXPECT_FALSE(client.receive(1500ms));
    EXPECT_EQ(clients(client), 1);
}

// A session reads nothing while a request of its client is under way; a frame that cannot be sent tells it.
TEST_F(ClientSilenceTest, OneThatGoesBeforeItsRecordingBeginsIsReportedAgain) {
    start();
    const auto wait_until_gone = [this](std::uint64_t client) {
        const auto end = std::chrono::steady_clock::now() + 60s;
        while (gone_ != client && std::chrono::steady_clock::now() < end) {
            server_->publish(feed_.next());
            std::this_thread::sleep_for(5ms);
        }
        return gone_ == client;
    };
    daemon::Reply answer;
    {
        WireClient client = connect(unix_);
        subscribe(client, subscription({v1::DISPARITY}));
        v1::Envelope request;
        request.mutable_record_start()->set_path("held.mkv");
        ASSERT_TRUE(client.send(request));
        answer = held_answer_.get_future().get();
    }
    EXPECT_TRUE(wait_until_gone(recorder_));
    gone_ = 0;
    answer(daemon::answer_of(
        [](v1::Envelope& told) { told.mutable_record_status(); }));  // it runs now, and its client was gone before
    EXPECT_TRUE(wait_until_gone(recorder_));
}

TEST_F(ClientSilenceTest, OneWhoseMachineHasVanishedIsNoticed) {
    if (!system_tells_of_connections()) {
        GTEST_SKIP() << "an emulator does not";
    }
    config_.idle_timeout = 0ms;
    config_.liveness = {1s, 1s, 1};
    start();
    WireClient observer = connect(unix_, "observer");
    WireClient quiet = connect(tcp_, "quiet");
    WireClient busy = connect(tcp_, "busy");
    WireClient lazy = connect(tcp_, "lazy");
    for (WireClient* client : {&busy, &lazy}) {
        subscribe(*client, subscription({v1::DISPARITY, v1::LEFT_COLOUR}));
    }
    ASSERT_EQ(clients(observer), 4);
    cut_off(quiet);
    cut_off(busy);
    server_->publish(feed_.next());
    EXPECT_TRUE(wait_for_clients(observer, 2)) << "one of those that have vanished is still there";
    // The other one does not read, but its system answers.
    const auto end = std::chrono::steady_clock::now() + 2 * config_.liveness.longest_silence();
    while (std::chrono::steady_clock::now() < end) {
        server_->publish(feed_.next());
        ASSERT_EQ(clients(observer), 2);
        std::this_thread::sleep_for(1ms);
    }
    EXPECT_TRUE(lazy.receive_frame());
}

}  // namespace
}  // namespace disparityd::test
