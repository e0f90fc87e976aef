// SPDX-License-Identifier: Apache-2.0
//
// What the sockets' thread copies of frames, told by the memory that it asks for.
#include <thread>

#include <gtest/gtest.h>

#include "tests/daemon/largest_allocation.h"
#include "tests/daemon/socket/server_fixture.h"

namespace disparityd::test {
namespace {

using FrameCopiesTest = ServerTest;

// A copy of the pixels would be a request for more bytes than one plane has.
TEST_F(FrameCopiesTest, NoPixelsOfARawFrameAreCopiedForAClient) {
    constexpr std::size_t smallest_plane = 640 * 480;
    feed_ = PatternFrames(640, 480, {v1::DISPARITY, v1::CONFIDENCE});
    start();
    std::vector<WireClient> clients;
    for (int i = 0; i < 4; ++i) {
        clients.push_back(connect(i % 2 == 0 ? tcp_ : unix_));
        subscribe(clients.back(), subscription({v1::DISPARITY, v1::CONFIDENCE}));
    }
    largest_allocation::reset();
    for (int round = 0; round < 10; ++round) {
        server_->publish(feed_.next());
        for (WireClient& client : clients) {
            const auto frame = client.receive_frame();
            ASSERT_TRUE(frame);
            EXPECT_EQ(frame->payload.size(), 3 * smallest_plane);
        }
    }
    EXPECT_GT(largest_allocation::bytes(), 0U);
    EXPECT_LT(largest_allocation::bytes(), smallest_plane);
}

// A recording that has not answered yet keeps the session alive, but not the frame that was on its way.
TEST_F(FrameCopiesTest, AClientThatHasLeftHoldsNoFrame) {
    constexpr std::size_t frame_bytes = 640 * 480 * 3;
    feed_ = PatternFrames(640, 480, {v1::LEFT_COLOUR});  // more than a Unix socket takes
    start(64, 1);
    daemon::Reply answer;
    {
        WireClient leaver = connect(unix_);
        subscribe(leaver, subscription({v1::LEFT_COLOUR}));
        server_->publish(feed_.next());
        v1::Envelope request;
        request.mutable_record_start()->set_path("held.mkv");
        ASSERT_TRUE(leaver.send(request));
        answer = held_answer_.get_future().get();
    }
    WireClient good = connect(tcp_);
    subscribe(good, subscription({v1::LEFT_COLOUR}));
    while (server_->gone() == 0) {
        std::this_thread::yield();
    }
    largest_allocation::reset();
    for (int i = 0; i < 4; ++i) {
        server_->publish(feed_.next());
        ASSERT_TRUE(good.receive_frame());
    }
    EXPECT_GT(largest_allocation::bytes(), 0U);
    EXPECT_LT(largest_allocation::bytes(), frame_bytes) << "what the client would still have got was copied";
}

}  // namespace
}  // namespace disparityd::test
