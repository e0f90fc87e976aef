// SPDX-License-Identifier: Apache-2.0
//
// What broken and hostile clients do to the server: each ends with an Error of its own, and nobody else notices.
#include <array>
#include <cerrno>
#include <cstring>
#include <random>
#include <thread>

#include <gmock/gmock.h>
#include <poll.h>
#include <sys/socket.h>

#include "proto/framing.h"
#include "tests/daemon/socket/server_fixture.h"

namespace disparityd::test {
namespace {

using ::testing::HasSubstr;
using namespace std::chrono_literals;

using AbusiveClientTest = ServerTest;

void send_length(WireClient& client, std::uint32_t length) {
    std::array<std::uint8_t, 4> bytes{};
    for (unsigned i = 0; i < 4; ++i) {
        bytes[i] = static_cast<std::uint8_t>(length >> (8 * i));
    }
    ASSERT_TRUE(client.send_bytes(bytes));
}

TEST_F(AbusiveClientTest, FourGigabytesAreRefusedBeforeTheyCome) {
    start();
    for (const bool greeted : {false, true}) {
        WireClient client = greeted ? connect(tcp_) : WireClient(tcp_);
        send_length(client, 0xffffffff);
        EXPECT_THAT(client.receive_error(), HasSubstr("4294967295 bytes announced, allowed 65536"));
        EXPECT_TRUE(client.is_closed());
    }
}

TEST_F(AbusiveClientTest, RandomBytesEndOnlyTheirConnection) {
    start();
    WireClient good = connect(unix_);
    subscribe(good, subscription({v1::DISPARITY}));
    std::mt19937 random(7);
    for (int round = 0; round < 30; ++round) {
        WireClient client(round % 2 == 0 ? tcp_ : unix_);
        std::vector<std::uint8_t> bytes(random() % 5000 + 8);
        for (auto& byte : bytes) {
            byte = static_cast<std::uint8_t>(random());
        }
        client.send_bytes(bytes);
        ::shutdown(client.descriptor(), SHUT_WR);
        EXPECT_TRUE(client.is_closed());
        server_->publish(feed_.next());
        const auto frame = good.receive_frame();
        ASSERT_TRUE(frame);
        EXPECT_EQ(frame->envelope.frame().skipped(), 0U);
    }
}

TEST_F(AbusiveClientTest, GarbageOfTheRightLengthIsRefused) {
    start();
    WireClient client = connect(tcp_);
    send_length(client, 10);
    ASSERT_TRUE(client.send_bytes(std::vector<std::uint8_t>(10, 0xff)));
    EXPECT_THAT(client.receive_error(), HasSubstr("10 bytes is no disparityd.v1.Envelope"));
    EXPECT_TRUE(client.is_closed());
}

TEST_F(AbusiveClientTest, BrokenProtocolIsNamed) {
    start();
    v1::Envelope request;
    request.mutable_status_request();
    {
        WireClient client(tcp_);
        client.send(request);
        EXPECT_THAT(client.receive_error(), HasSubstr("first message must be Hello"));
        EXPECT_TRUE(client.is_closed());
    }
    {
        WireClient client(tcp_);
        v1::Envelope hello;
        hello.mutable_hello()->set_protocol_version(99);
        client.send(hello);
        EXPECT_THAT(client.receive_error(), HasSubstr("protocol version 99"));
        EXPECT_TRUE(client.is_closed());
    }
    {
        WireClient client = connect(tcp_);
        v1::Envelope hello;
        hello.mutable_hello()->set_protocol_version(proto::protocol_version);
        client.send(hello);
        EXPECT_THAT(client.receive_error(), HasSubstr("Hello came twice"));
    }
    {
        WireClient client = connect(tcp_);
        request.set_payload_bytes(5);
        client.send(request);
        EXPECT_THAT(client.receive_error(), HasSubstr("payload of 5 bytes"));
    }
    {
        WireClient client = connect(tcp_);
        v1::Envelope frame;
        frame.mutable_frame();
        client.send(frame);
        EXPECT_THAT(client.receive_error(), HasSubstr("not for clients"));
        EXPECT_TRUE(client.is_closed());
    }
}

TEST_F(AbusiveClientTest, SilentConnectionIsClosed) {
    start();
    const auto begin = std::chrono::steady_clock::now();
    WireClient client(tcp_);
    EXPECT_THAT(client.receive_error(), HasSubstr("no Hello within 5 s"));
    EXPECT_TRUE(client.is_closed());
    EXPECT_GE(std::chrono::steady_clock::now() - begin, 5s);
}

TEST_F(AbusiveClientTest, AMessageThatComesAfterTheRefusalIsDiscarded) {
    start();
    {
        WireClient client(tcp_);
        send_length(client, 1000);
        EXPECT_THAT(client.receive_error(), HasSubstr("no Hello within 5 s"));
        for (int i = 0; i < 4 && client.send_bytes(std::vector<std::uint8_t>(2000, 0xee)); ++i) {
        }
        EXPECT_TRUE(client.is_closed());
    }
    connect(tcp_);
}

TEST_F(AbusiveClientTest, TooManyClientsAreToldSo) {
    start(2);
    WireClient first = connect(unix_);
    WireClient second = connect(tcp_);
    {
        WireClient third(tcp_);
        EXPECT_THAT(third.receive_error(), HasSubstr("[socket] max_clients = 2"));
        EXPECT_TRUE(third.is_closed());
    }
    EXPECT_EQ(status(first).clients_size(), 2);
    ::shutdown(second.descriptor(), SHUT_RDWR);
    while (status(first).clients_size() != 1) {
        std::this_thread::yield();
    }
    connect(tcp_);
}

TEST_F(AbusiveClientTest, OneThatStopsReadingIsSkippedAndOthersAreNot) {
    feed_ = PatternFrames(640, 480, {v1::DISPARITY, v1::CONFIDENCE});
    start();
    WireClient lazy = connect(tcp_, "lazy");
    subscribe(lazy, subscription({v1::DISPARITY, v1::CONFIDENCE}));
    WireClient good = connect(tcp_, "good");
    subscribe(good, subscription({v1::CONFIDENCE}));
    for (std::uint64_t i = 0; i < 60; ++i) {
        server_->publish(feed_.next());
        const auto frame = good.receive_frame();
        ASSERT_TRUE(frame);
        ASSERT_EQ(frame->envelope.frame().publish_index(), i);
        ASSERT_EQ(frame->envelope.frame().skipped(), 0U);
    }
    // It stays connected and learns how much it missed.
    std::uint64_t seen = 0;
    std::uint64_t missed = 0;
    std::uint64_t last = 0;
    while (const auto frame = lazy.receive_frame(last == 59 ? 0ms : 5000ms)) {
        ++seen;
        missed += frame->envelope.frame().skipped();
        last = frame->envelope.frame().publish_index();
        const auto dense = PatternFrames::expected(last, v1::DISPARITY, 0, 0, 640, 480);
        ASSERT_TRUE(std::equal(dense.begin(), dense.end(), frame->payload.begin()));
    }
    EXPECT_EQ(last, 59U);
    EXPECT_EQ(seen + missed, 60U);
    EXPECT_GT(missed, 0U);
}

// Each has stopped in the middle of another frame, and there are more of them than copies in the pool.
TEST_F(AbusiveClientTest, ThoseWhoStopReadingHoldNoFramesBack) {
    const std::vector<v1::Product> products{v1::DISPARITY, v1::LEFT_COLOUR};
    feed_ = PatternFrames(640, 480, products);  // more than a Unix socket takes
    start(64, 1);
    WireClient good = connect(tcp_, "good");
    subscribe(good, subscription({v1::LEFT_COLOUR}));
    std::vector<WireClient> lazy;
    for (std::uint64_t n = 0; n < 20; ++n) {
        lazy.push_back(connect(unix_));
        subscribe(lazy.back(), subscription(products));
        server_->publish(feed_.next());
        const auto frame = good.receive_frame();
        ASSERT_TRUE(frame);
        ASSERT_EQ(frame->envelope.frame().publish_index(), n);
        ASSERT_EQ(frame->payload, PatternFrames::expected(n, v1::LEFT_COLOUR, 0, 0, 640, 480));
    }
    EXPECT_EQ(server_->lost(), 0U);
    for (std::uint64_t n = 0; n < lazy.size(); ++n) {
        const auto frame = lazy[n].receive_frame();
        ASSERT_TRUE(frame) << n;
        EXPECT_EQ(frame->envelope.frame().publish_index(), n);
        auto planes = PatternFrames::expected(n, v1::DISPARITY, 0, 0, 640, 480);
        const auto colour = PatternFrames::expected(n, v1::LEFT_COLOUR, 0, 0, 640, 480);
        planes.insert(planes.end(), colour.begin(), colour.end());
        EXPECT_EQ(frame->payload, planes) << n;
    }
}

TEST_F(AbusiveClientTest, RequestsWithoutReadingAreHeldBack) {
    config_.request_interval = {};
    start();
    WireClient flood = connect(tcp_, "flood");
    v1::Envelope request;
    request.mutable_status_request();
    std::vector<std::uint8_t> one;
    proto::encode(request, one);
    std::vector<std::uint8_t> many;
    for (int i = 0; i < 1000; ++i) {
        many.insert(many.end(), one.begin(), one.end());
    }
    // Until the server reads no more: it keeps a few answers for the client, not one for each request.
    const auto end = std::chrono::steady_clock::now() + 60s;
    const auto server_reads = [&] {
        pollfd writable{flood.descriptor(), POLLOUT, 0};
        return ::poll(&writable, 1, 1000) == 1;
    };
    std::size_t at = 0;
    bool reads = server_reads();
    while (reads && std::chrono::steady_clock::now() < end) {
        const ssize_t sent =
            ::send(flood.descriptor(), many.data() + at, many.size() - at, MSG_NOSIGNAL | MSG_DONTWAIT);
        ASSERT_GT(sent, 0) << std::strerror(errno);
        at = (at + static_cast<std::size_t>(sent)) % many.size();
        reads = server_reads();
    }
    EXPECT_FALSE(reads);
    WireClient good = connect(tcp_, "good");
    EXPECT_EQ(status(good).clients_size(), 2);
}

TEST_F(AbusiveClientTest, RequestsComeAtALimitedRate) {
    config_.request_interval = 20ms;
    start();
    WireClient flood = connect(tcp_, "flood");
    v1::Envelope request;
    request.mutable_status_request();
    const int requests = daemon::ClientRules::most_at_once + 50;
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < requests; ++i) {
        ASSERT_TRUE(flood.send(request));
    }
    WireClient good = connect(tcp_, "good");
    EXPECT_EQ(status(good).clients_size(), 2) << "it does not wait for the other one";
    for (int i = 0; i < requests; ++i) {
        const auto answer = flood.receive();
        ASSERT_TRUE(answer && answer->envelope.has_status()) << i;
    }
    EXPECT_GE(std::chrono::steady_clock::now() - begin, 49 * config_.request_interval);
}

TEST_F(AbusiveClientTest, LongRequestsCountAsSeveral) {
    config_.request_interval = 5ms;
    start();
    WireClient flood = connect(tcp_, "flood");
    v1::Envelope request;
    constexpr int counts_as = 10;
    for (std::size_t i = 0; i < counts_as * daemon::ClientRules::bytes_of_one; ++i) {
        request.mutable_subscribe()->add_products(v1::DISPARITY);  // one byte each
    }
    const auto begin = std::chrono::steady_clock::now();
    constexpr int messages = 2 * daemon::ClientRules::most_at_once / counts_as;
    for (int i = 0; i < messages; ++i) {
        ASSERT_TRUE(flood.send(request));
    }
    EXPECT_NO_THROW(status(flood));
    EXPECT_GE(std::chrono::steady_clock::now() - begin, daemon::ClientRules::most_at_once * config_.request_interval);
}

// As a trace, of which only one may wait for a client.
TEST_F(AbusiveClientTest, WhatALongAnswerHoldsIsKeptUntilItIsRead) {
    start();
    WireClient client = connect(unix_);
    v1::Envelope request;
    request.mutable_record_start()->set_path("held.mkv");
    ASSERT_TRUE(client.send(request));
    daemon::Answer answer{std::vector<v1::Envelope>(16), "", std::make_shared<char>()};
    for (v1::Envelope& message : answer.messages) {
        message.mutable_record_status()->set_error(std::string(900'000, 'x'));
    }
    const std::weak_ptr<const void> held = answer.held;
    held_answer_.get_future().get()(std::move(answer));
    for (std::size_t i = 0; i < 16; ++i) {
        ASSERT_FALSE(held.expired()) << "messages read: " << i;
        const auto message = client.receive();
        ASSERT_TRUE(message && message->envelope.has_record_status());
    }
    v1::Envelope status;
    status.mutable_status_request();
    client.send(status);
    EXPECT_TRUE(client.receive());
    EXPECT_TRUE(held.expired()) << "all were read";
}

TEST_F(AbusiveClientTest, FiftyComeAndGoWhileOneMissesNothing) {
    start(64, 8);
    WireClient good = connect(unix_, "good");
    subscribe(good, subscription({v1::DISPARITY}));
    std::vector<WireClient> crowd;
    for (std::uint64_t i = 0; i < 100; ++i) {
        if (i < 50) {
            crowd.push_back(connect(i % 2 == 0 ? tcp_ : unix_));
            ASSERT_TRUE(crowd.back().send(subscription({v1::DISPARITY, v1::LEFT})));
        } else {
            crowd.pop_back();
        }
        server_->publish(feed_.next());
        const auto frame = good.receive_frame();
        ASSERT_TRUE(frame);
        ASSERT_EQ(frame->envelope.frame().publish_index(), i);
        ASSERT_EQ(frame->payload, PatternFrames::expected(i, v1::DISPARITY, 0, 0, 64, 48));
    }
}

}  // namespace
}  // namespace disparityd::test
