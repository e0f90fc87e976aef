// SPDX-License-Identifier: Apache-2.0
//
// Memory that runs out in the middle of anything: a client may be closed for it; the server, the compressor and whoever
// comes afterwards go on.
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/failure_text.h"
#include "pipeline/worker_pool.h"
#include "tests/daemon/failing_memory.h"
#include "tests/daemon/socket/server_fixture.h"

namespace disparityd::test {
namespace {

using namespace std::chrono_literals;

class MemoryFailureTest : public ServerTest {
protected:
    ~MemoryFailureTest() override { failing_memory::stop(); }

    /// What a client does in its life: connects, subscribes, gets frames and samples, asks and is answered. Every step
    /// may fail; whether all went well.
    bool live(const v1::Envelope& subscription) {
        try {
            WireClient client(tcp_);
            if (!client.hello() || !client.send(subscription)) {
                return false;
            }
            status(client);
            const capture::SensorSample sample{};
            server_->publish_sensors(std::span(&sample, 1), std::chrono::steady_clock::now());
            for (int frame = 0; frame < 2; ++frame) {
                server_->publish(feed_.next());
                if (!client.receive_frame(1s)) {
                    return false;
                }
            }
            v1::Envelope camera;
            camera.mutable_camera_request()->add_settings()->set_name("gain");
            return client.record("a.mkv") && client.record("") && client.send(camera) && client.receive(1s);
        } catch (const std::runtime_error&) {
            return false;  // no connection, or none any more
        }
    }

    static v1::Envelope wanted(v1::Encoding encoding) {
        v1::Envelope message = subscription({v1::DISPARITY, v1::LEFT});
        message.mutable_subscribe()->set_encoding(encoding);
        message.mutable_subscribe()->set_sensors(true);
        message.mutable_subscribe()->set_status_interval_s(0.1);
        return message;
    }

    /// Once memory is back: asked by the watchdog, as the daemon does, the server mends what it could not see to.
    void expect_all_is_well(const v1::Envelope& subscription, std::uint64_t number) {
        const auto deadline = std::chrono::steady_clock::now() + 60s;
        bool well = false;
        while (!well && std::chrono::steady_clock::now() < deadline) {
            server_->silence();
            well = live(subscription);
        }
        ASSERT_TRUE(well) << "after request " << number << " was refused";
    }

    void refuse_each_in_turn(v1::Encoding encoding, std::uint64_t count) {
        config_.access.tcp_control = true;
        start();
        const v1::Envelope subscription = wanted(encoding);
        ASSERT_NO_FATAL_FAILURE(expect_all_is_well(subscription, 0));
        std::uint64_t refused = 1;
        std::uint64_t number = 0;
        for (; refused > 0; ++number) {
            failing_memory::fail(number, count);
            live(subscription);
            refused = failing_memory::stop();
            ASSERT_NO_FATAL_FAILURE(expect_all_is_well(subscription, number));
        }
        EXPECT_GT(number, 30U) << "a client's life takes memory more often than that";
    }
};

TEST_F(MemoryFailureTest, OneRefusalCostsOneClientAtMost) {
    refuse_each_in_turn(v1::RAW, 1);
}

TEST_F(MemoryFailureTest, OneRefusalNeverStopsTheCompressor) {
    refuse_each_in_turn(v1::ZSTD, 1);
}

TEST_F(MemoryFailureTest, TheServerOutlivesATimeWithoutMemory) {
    refuse_each_in_turn(v1::ZSTD, 1'000'000);
}

// A copy of the pixels would be a request for more bytes than one plane has.
TEST_F(MemoryFailureTest, NoPixelsOfARawFrameAreCopiedForAClient) {
    constexpr std::size_t smallest_plane = 640 * 480;
    feed_ = PatternFrames(640, 480, {v1::DISPARITY, v1::CONFIDENCE});
    start();
    std::vector<WireClient> clients;
    for (int i = 0; i < 4; ++i) {
        clients.push_back(connect(i % 2 == 0 ? tcp_ : unix_));
        subscribe(clients.back(), subscription({v1::DISPARITY, v1::CONFIDENCE}));
    }
    failing_memory::fail(0, 0);  // counts only
    for (int round = 0; round < 10; ++round) {
        server_->publish(feed_.next());
        for (WireClient& client : clients) {
            const auto frame = client.receive_frame();
            ASSERT_TRUE(frame);
            EXPECT_EQ(frame->payload.size(), 3 * smallest_plane);
        }
    }
    failing_memory::stop();
    EXPECT_GT(failing_memory::largest(), 0U);
    EXPECT_LT(failing_memory::largest(), smallest_plane);
}

// What it still needs of its frame would be copied when the frame leaves the ring.
TEST_F(MemoryFailureTest, AClientWhoseFrameCannotBeKeptIsClosed) {
    constexpr std::size_t frame_bytes = 640 * 480 * 3;
    feed_ = PatternFrames(640, 480, {v1::LEFT_COLOUR});  // more than a Unix socket takes
    start(64, 1);
    WireClient lazy = connect(unix_);
    subscribe(lazy, subscription({v1::LEFT_COLOUR}));
    server_->publish(feed_.next());
    WireClient good = connect(tcp_);
    subscribe(good, subscription({v1::LEFT_COLOUR}));
    failing_memory::fail_above(frame_bytes / 2);
    for (int i = 0; i < 8; ++i) {
        server_->publish(feed_.next());
        ASSERT_TRUE(good.receive_frame()) << "the memory of the frame that was lost is used again";
    }
    EXPECT_EQ(failing_memory::stop(), 1U);
    EXPECT_TRUE(lazy.is_closed());
    EXPECT_EQ(server_->lost(), 0U);
}

// A recording that has not answered yet keeps the session alive, but not the frame that was on its way.
TEST_F(MemoryFailureTest, AClientThatHasLeftHoldsNoFrame) {
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
    failing_memory::fail(0, 0);  // counts only
    for (int i = 0; i < 4; ++i) {
        server_->publish(feed_.next());
        ASSERT_TRUE(good.receive_frame());
    }
    failing_memory::stop();
    EXPECT_GT(failing_memory::largest(), 0U);
    EXPECT_LT(failing_memory::largest(), frame_bytes) << "what the client would still have got was copied";
}

TEST(FailureText, IsForPeople) {
    const auto of = [](auto error) { return base::failure_text(std::make_exception_ptr(error)); };
    EXPECT_THAT(of(std::bad_alloc()), testing::StartsWith("not enough memory: "));
    EXPECT_THAT(of(std::length_error("vector::_M_default_append")), testing::StartsWith("not enough memory: "));
    EXPECT_EQ(of(std::runtime_error("the disk is full")), "the disk is full");
    EXPECT_EQ(of(7), "an unknown failure");
}

TEST(WorkerPool, WhatATaskThrowsComesToTheCaller) {
    pipeline::WorkerPool workers(3);
    std::atomic<int> ended{0};
    const auto task = [&](int index) {
        if (index % 10 == 3) {
            throw std::bad_alloc();
        }
        ++ended;
    };
    EXPECT_THROW(workers.for_each(100, task), std::bad_alloc);
    EXPECT_EQ(ended, 90) << "all the others are run";
    ended = 0;
    workers.for_each(3, task);
    EXPECT_EQ(ended, 3) << "and the pool works on";
}

}  // namespace
}  // namespace disparityd::test
