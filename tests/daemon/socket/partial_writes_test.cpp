// SPDX-License-Identifier: Apache-2.0
//
// Connections that take a few bytes at a time, are interrupted, or break in the middle of a message.
#include <cerrno>

#include <gtest/gtest.h>

#include "tests/daemon/limited_sends.h"
#include "tests/daemon/socket/server_fixture.h"

namespace disparityd::test {
namespace {

using namespace std::chrono_literals;

class PartialWritesTest : public ServerTest {
protected:
    ~PartialWritesTest() override { limited_sends::stop(); }

    static std::vector<std::uint8_t> expected(std::uint64_t frame) {
        auto planes = PatternFrames::expected(frame, v1::DISPARITY, 0, 0, 64, 48);
        const auto left = PatternFrames::expected(frame, v1::LEFT, 0, 0, 64, 48);
        planes.insert(planes.end(), left.begin(), left.end());
        return planes;
    }
};

TEST_F(PartialWritesTest, EveryByteArrivesHoweverFewAreTakenAtOnce) {
    start();
    WireClient whole = connect(tcp_);
    WireClient compressed = connect(unix_);
    subscribe(whole, subscription({v1::DISPARITY, v1::LEFT}));
    v1::Envelope zstd = subscription({v1::LEFT});
    zstd.mutable_subscribe()->set_encoding(v1::ZSTD);
    subscribe(compressed, zstd);
    std::uint64_t frame = 0;
    for (const int error : {0, EAGAIN, EINTR}) {
        for (const std::size_t bytes : {3U, 100U, 7000U}) {
            limited_sends::limit(bytes, {error, 0, 2});
            server_->publish(feed_.next());
            const auto raw = whole.receive_frame(60s);
            ASSERT_TRUE(raw) << bytes << " bytes at once, error " << error;
            EXPECT_EQ(raw->envelope.frame().publish_index(), frame);
            EXPECT_EQ(raw->payload, expected(frame)) << bytes << " bytes at once, error " << error;
            const auto packed = compressed.receive_frame(60s);
            ASSERT_TRUE(packed) << bytes << " bytes at once, error " << error;
            EXPECT_EQ(packed->envelope.frame().publish_index(), frame);
            ++frame;
        }
    }
    limited_sends::stop();
    const v1::Status told = status(whole);
    for (const v1::ClientStatus& client : told.clients()) {
        EXPECT_EQ(client.frames_sent(), frame);
        EXPECT_EQ(client.frames_skipped(), 0U);
    }
}

TEST_F(PartialWritesTest, AConnectionThatBreaksInTheMiddleOfAFrameEndsAlone) {
    start();
    WireClient good = connect(tcp_);
    std::uint64_t gone = 0;
    for (const int error : {EPIPE, ECONNRESET, ENOBUFS}) {
        WireClient broken = connect(unix_);
        subscribe(broken, subscription({v1::DISPARITY, v1::LEFT}));
        limited_sends::limit(100, {error, 5});
        server_->publish(feed_.next());
        EXPECT_FALSE(broken.receive_frame()) << "error " << error;
        EXPECT_TRUE(broken.is_closed()) << "error " << error;
        limited_sends::stop();
        EXPECT_EQ(status(good).clients_size(), 1);
        EXPECT_EQ(server_->gone(), ++gone);
    }
    subscribe(good, subscription({v1::DISPARITY, v1::LEFT}));
    server_->publish(feed_.next());
    const auto frame = good.receive_frame();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->payload, expected(3));
}

TEST_F(PartialWritesTest, AConnectionThatIsClosedForAnErrorIsShutDownOnce) {
    start();
    WireClient good = connect(tcp_);
    subscribe(good, subscription({v1::LEFT}));
    WireClient bad = connect(unix_);
    const std::uint64_t before = limited_sends::shutdowns();
    const auto refusal = bad.hello();  // for the second time
    ASSERT_TRUE(refusal && refusal->has_error());
    for (int i = 0; i < 10; ++i) {
        server_->publish(feed_.next());
        ASSERT_TRUE(good.receive_frame());
    }
    EXPECT_EQ(limited_sends::shutdowns() - before, 1U);
}

}  // namespace
}  // namespace disparityd::test
