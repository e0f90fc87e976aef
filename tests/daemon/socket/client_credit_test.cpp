// SPDX-License-Identifier: Apache-2.0
//
// A client that gives credit is sent the newest frame, and no other client notices.
#include <array>

#include "proto/framing.h"
#include "proto/monotonic_clock.h"
#include "tests/daemon/socket/server_fixture.h"

namespace disparityd::test {
namespace {

using namespace std::chrono_literals;

v1::Envelope by_credit(const std::vector<v1::Product>& products, v1::Encoding encoding = v1::RAW) {
    v1::Envelope request = subscription(products);
    request.mutable_subscribe()->set_by_credit(true);
    request.mutable_subscribe()->set_encoding(encoding);
    return request;
}

v1::Envelope ready(std::uint32_t frames = 1) {
    v1::Envelope message;
    message.mutable_ready()->set_frames(frames);
    return message;
}

v1::Envelope hello_of(std::uint64_t client) {
    v1::Envelope message;
    message.mutable_hello()->set_protocol_version(proto::protocol_version);
    message.mutable_hello()->set_client_id(client);
    return message;
}

class ClientCreditTest : public ServerTest {
protected:
    void publish(int count = 1) {
        for (int i = 0; i < count; ++i) {
            const daemon::PublishedFrame frame = feed_.next();
            newest_ = frame.info.publish_index;
            server_->publish(frame);
        }
    }

    /// Publishes so many frames, each after the server has taken in the one before.
    void publish_slowly(int count) {
        WireClient observer = connect(unix_);
        for (int i = 0; i < count; ++i) {
            publish();
            status(observer);
        }
    }

    /// Whether a question sent now is answered before any frame comes.
    static bool nothing_waits(WireClient& client) {
        v1::Envelope question;
        question.mutable_status_request();
        client.send(question);
        const auto message = client.receive();
        return message && message->envelope.has_status();
    }

    static std::uint64_t next_index(WireClient& client) {
        const auto message = client.receive_frame();
        return message ? message->envelope.frame().publish_index() : UINT64_MAX;
    }

    std::uint64_t newest_ = 0;
};

TEST_F(ClientCreditTest, EachFrameIsTheNewestWhenItIsSent) {
    start();
    for (const std::string& address : {tcp_, unix_}) {
        for (const auto& products : {std::vector{v1::SCAN}, std::vector{v1::SCAN, v1::LEFT, v1::DISPARITY}}) {
            for (const v1::Encoding encoding : {v1::RAW, v1::ZSTD}) {
                WireClient client = connect(address);
                subscribe(client, by_credit(products, encoding));
                publish(3);
                EXPECT_TRUE(nothing_waits(client)) << "sent without credit";
                client.send(ready());
                EXPECT_EQ(next_index(client), newest_);
                publish(2);
                EXPECT_TRUE(nothing_waits(client)) << "sent without credit";
                client.send(ready());
                const auto message = client.receive_frame();
                ASSERT_TRUE(message);
                EXPECT_EQ(message->envelope.frame().publish_index(), newest_);
                EXPECT_EQ(message->envelope.frame().skipped(), 1U);
            }
        }
    }
}

TEST_F(ClientCreditTest, CreditWaitsForTheNextFrame) {
    start();
    for (const v1::Encoding encoding : {v1::RAW, v1::ZSTD}) {
        WireClient client = connect(tcp_);
        subscribe(client, by_credit({v1::DISPARITY}, encoding));
        client.send(ready(2));
        EXPECT_TRUE(nothing_waits(client));
        for (int i = 0; i < 2; ++i) {
            publish();
            EXPECT_EQ(next_index(client), newest_);
        }
        publish();
        EXPECT_TRUE(nothing_waits(client)) << "more frames than credit";
    }
}

TEST_F(ClientCreditTest, SixteenAreKeptAndASubscribeBeginsAnew) {
    start();
    WireClient client = connect(unix_);
    subscribe(client, by_credit({v1::SCAN}));
    client.send(ready(UINT32_MAX));
    client.send(ready(5));
    EXPECT_TRUE(nothing_waits(client));
    for (int i = 0; i < 16; ++i) {
        publish();
        ASSERT_EQ(next_index(client), newest_);
    }
    publish();
    EXPECT_TRUE(nothing_waits(client));
    client.send(ready(3));
    EXPECT_EQ(next_index(client), newest_);
    subscribe(client, by_credit({v1::SCAN}));
    publish();
    EXPECT_TRUE(nothing_waits(client)) << "credit of the subscription before";
}

TEST_F(ClientCreditTest, CreditGivenBeforeTheFirstSourceHolds) {
    start();
    server_->set_layout({});
    WireClient client = connect(unix_);
    client.send(by_credit({v1::SCAN}));
    client.send(ready());
    EXPECT_TRUE(nothing_waits(client));
    server_->set_layout(feed_.layout());
    EXPECT_TRUE(nothing_waits(client));
    publish();
    EXPECT_EQ(next_index(client), newest_);
}

TEST_F(ClientCreditTest, ARateIsKept) {
    start();
    WireClient client = connect(unix_);
    v1::Envelope request = by_credit({v1::SCAN});
    request.mutable_subscribe()->set_max_rate(0.01);
    subscribe(client, request);
    client.send(ready(16));
    publish();
    EXPECT_EQ(next_index(client), newest_);
    publish(3);
    EXPECT_TRUE(nothing_waits(client)) << "before the rate allows it";
}

TEST_F(ClientCreditTest, CreditIsNoRequest) {
    config_.request_interval = 100s;  // after 200 requests nothing more would be read
    start();
    WireClient client = connect(unix_);
    subscribe(client, by_credit({v1::SCAN}));
    for (int i = 0; i < 400; ++i) {
        client.send(ready());
        publish();
        ASSERT_EQ(next_index(client), newest_);
    }
    EXPECT_TRUE(nothing_waits(client));
}

TEST_F(ClientCreditTest, APingIsAnsweredWithTheClock) {
    start();
    for (const std::string& address : {tcp_, unix_}) {
        WireClient client(address);
        const std::int64_t before_hello = proto::monotonic_ns();
        const auto welcome = client.hello();
        ASSERT_TRUE(welcome);
        EXPECT_GE(welcome->welcome().monotonic_ns(), before_hello);
        v1::Envelope ping;
        ping.mutable_ping()->set_client_ns(-17);
        const std::int64_t before = proto::monotonic_ns();
        client.send(ping);
        const auto answer = client.receive();
        const std::int64_t after = proto::monotonic_ns();
        ASSERT_TRUE(answer && answer->envelope.has_pong());
        EXPECT_EQ(answer->envelope.pong().client_ns(), -17);
        EXPECT_GE(answer->envelope.pong().monotonic_ns(), before);
        EXPECT_LE(answer->envelope.pong().monotonic_ns(), after);
    }
}

TEST_F(ClientCreditTest, AFrameSaysWhenItWasSent) {
    start();
    for (const v1::Encoding encoding : {v1::RAW, v1::ZSTD}) {
        WireClient client = connect(tcp_);
        subscribe(client, by_credit({v1::LEFT}, encoding));
        client.send(ready());
        const daemon::PublishedFrame sent = feed_.next();
        const std::int64_t before = proto::monotonic_ns();
        server_->publish(sent);
        const auto message = client.receive_frame();
        const std::int64_t after = proto::monotonic_ns();
        ASSERT_TRUE(message);
        const v1::Frame& frame = message->envelope.frame();
        EXPECT_GE(frame.sent_monotonic_ns(), before);
        EXPECT_LE(frame.sent_monotonic_ns(), after);
        EXPECT_EQ(frame.sent_monotonic_ns() - frame.age_ns(),
                  std::chrono::nanoseconds(sent.captured.time_since_epoch()).count());
    }
}

TEST_F(ClientCreditTest, AClientThatComesBackEndsItsOldConnection) {
    start();
    WireClient old(tcp_);
    old.send(hello_of(77));
    ASSERT_TRUE(old.receive());
    std::array<WireClient, 3> others{WireClient(tcp_), WireClient(unix_), WireClient(tcp_)};
    others[0].send(hello_of(78));  // another client
    others[1].send(hello_of(77));  // another way in: it need not be the same program
    others[2].send(hello_of(0));   // an old client
    for (WireClient& other : others) {
        ASSERT_TRUE(other.receive());
    }
    EXPECT_TRUE(nothing_waits(old));
    WireClient anew(tcp_);
    anew.send(hello_of(77));
    ASSERT_TRUE(anew.receive());
    EXPECT_TRUE(old.is_closed());
    WireClient without_id(tcp_);
    without_id.send(hello_of(0));
    ASSERT_TRUE(without_id.receive());
    for (WireClient& other : others) {
        EXPECT_TRUE(nothing_waits(other));
    }
    EXPECT_TRUE(nothing_waits(anew));
}

// It reads nothing, as a program that works on one frame for long. The system's buffers took hundreds of small frames.
TEST_F(ClientCreditTest, AnOldClientOnTheUnixSocketFindsFewOldFrames) {
    config_.idle_timeout = 100ms;  // the server looks around every 25 ms
    start();
    WireClient client = connect(unix_);
    subscribe(client, subscription({v1::SCAN}));
    publish_slowly(300);
    std::uint64_t received = 0;
    std::uint64_t last = 0;
    while (last != newest_) {
        const auto message = client.receive_frame();
        ASSERT_TRUE(message) << "after frame " << last;
        last = message->envelope.frame().publish_index();
        ++received;
    }
    EXPECT_LE(received, 20U) << "of 300, with a ring of 4";
}

}  // namespace
}  // namespace disparityd::test
