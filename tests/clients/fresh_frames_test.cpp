// SPDX-License-Identifier: Apache-2.0
//
// However long a program works on a frame, it gets the newest one, and its age. A server in this process publishes all
// the time; what is judged are the numbers of frames, and ages against readings of the clock before and after.
#include <atomic>
#include <mutex>
#include <thread>
#include <tuple>
#include <vector>

#include <disparity_client.h>
#include <disparity_client.hpp>
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include "proto/monotonic_clock.h"
#include "tests/certificate_folder.h"
#include "tests/daemon/socket/server_fixture.h"

namespace disparityd::test {
namespace {

using disparity::Frame;
using disparity::Product;
using disparity::ReadResult;
using disparity::SocketClient;
using ::testing::HasSubstr;
using namespace std::chrono_literals;

constexpr auto patience = 60s;
constexpr auto interval = 20ms;

/// A server that publishes a frame every 20 ms, captured that instant.
class FreshFramesTest : public ServerTest {
protected:
    ~FreshFramesTest() override {
        publishing_.request_stop();
        if (publishing_.joinable()) {
            publishing_.join();
        }
    }

    void start_publishing() {
        start();
        publishing_ = std::jthread([this](const std::stop_token& stop) {
            while (!stop.stop_requested()) {
                daemon::PublishedFrame frame = feed_.next();
                frame.captured = std::chrono::steady_clock::now();
                frame.published = frame.captured;
                {
                    const std::lock_guard lock(mutex_);
                    captured_.push_back(std::chrono::nanoseconds(frame.captured.time_since_epoch()).count());
                }
                server_->publish(frame);
                std::this_thread::sleep_for(interval);
            }
        });
    }

    std::uint64_t published() {
        const std::lock_guard lock(mutex_);
        return captured_.size();
    }

    std::int64_t captured(std::uint64_t index) {
        const std::lock_guard lock(mutex_);
        return captured_.at(index);
    }

    disparity::ConnectOptions options() const {
        disparity::ConnectOptions options;
        options.authority = files_.client("").authority;
        return options;
    }

    /// Reads frames and works on each. Returns how many frames the oldest one was behind the newest at the call.
    std::uint64_t farthest_behind(SocketClient& client, std::chrono::milliseconds work, int count) {
        std::uint64_t most = 0;
        Frame frame;
        for (int i = 0; i < count; ++i) {
            const std::uint64_t before = published();
            const std::int64_t called = proto::monotonic_ns();
            EXPECT_EQ(client.read(frame, patience), ReadResult::frame) << client.why_gone();
            const std::int64_t returned = proto::monotonic_ns();
            EXPECT_GE(frame.age_ns, called - captured(frame.publish_index)) << "told younger than it is";
            EXPECT_LE(frame.age_ns, returned - captured(frame.publish_index)) << "told older than it is";
            if (before > frame.publish_index + 1) {
                most = std::max(most, before - frame.publish_index - 1);
            }
            std::this_thread::sleep_for(work);
        }
        return most;
    }

    std::atomic<bool> done_{false};
    std::mutex mutex_;
    std::vector<std::int64_t> captured_;  ///< by publish index
    CertificateFolder files_;
    std::jthread publishing_;
};

// Some intervals more are for a machine that is busy with other things: without credit it were 60 frames and more.
constexpr std::uint64_t few = 6;

TEST_F(FreshFramesTest, ASlowProgramGetsTheNewestFrame) {
    const std::vector scan{Product::scan};
    const std::vector images{Product::scan, Product::left};
    start_publishing();
    for (const auto& [address, compressed, products] :
         {std::tuple{tcp_, false, scan}, {tcp_, true, images}, {unix_, false, images}, {unix_, true, scan}}) {
        SocketClient client(address);
        client.subscribe({.products = products, .compressed = compressed});
        EXPECT_LE(farthest_behind(client, 10 * interval, 6), few) << address << compressed;
        std::this_thread::sleep_for(20 * interval);
        EXPECT_LE(farthest_behind(client, 0ms, 3), few) << "after a pause " << address << compressed;
    }
}

TEST_F(FreshFramesTest, ASlowProgramOverTls) {
    config_.tls = proto::make_server_tls(files_.server(false), "test");
    start_publishing();
    SocketClient client(tcp_, options());
    client.subscribe({.products = {Product::scan, Product::disparity}});
    EXPECT_LE(farthest_behind(client, 10 * interval, 8), few);
}

TEST_F(FreshFramesTest, AProgramThatKeepsUpMissesNothingForLong) {
    start_publishing();
    SocketClient client(unix_);
    client.subscribe({.products = {Product::scan}});
    Frame frame;
    ASSERT_EQ(client.read(frame, patience), ReadResult::frame);
    int in_a_row = 0;
    for (int i = 0; i < 1000 && in_a_row < 20; ++i) {
        ASSERT_EQ(client.read(frame, patience), ReadResult::frame);
        in_a_row = frame.skipped == 0 ? in_a_row + 1 : 0;
    }
    EXPECT_EQ(in_a_row, 20) << "frames one after the other";
}

// A program with a loop of its own, which never waits.
TEST_F(FreshFramesTest, LooksWithoutWaitingFindFreshFrames) {
    start_publishing();
    SocketClient client(tcp_);
    client.subscribe({.products = {Product::scan}});
    Frame frame;
    int found = 0;
    for (int i = 0; i < 2000 && found < 5; ++i) {
        const std::uint64_t before = published();
        if (client.read(frame, 0ms) == ReadResult::frame) {
            ++found;
            EXPECT_LE(before, frame.publish_index + 1 + few);
        }
        std::this_thread::sleep_for(5 * interval);
    }
    EXPECT_EQ(found, 5);
}

TEST_F(FreshFramesTest, WhatIsKeptDuringAQuestionIsNotGivenOld) {
    start_publishing();
    SocketClient client(unix_);
    client.subscribe({.products = {Product::scan}});
    farthest_behind(client, 0ms, 3);
    std::this_thread::sleep_for(5 * interval);
    EXPECT_FALSE(client.status(patience).empty());  // it keeps the frame that lies in the socket
    std::this_thread::sleep_for(25 * interval);
    EXPECT_LE(farthest_behind(client, 0ms, 1), few);
}

TEST_F(FreshFramesTest, TheAgeInC) {
    start_publishing();
    disparity_socket* client = disparity_socket_open(unix_.c_str(), "c", 60'000);
    ASSERT_NE(client, nullptr) << disparity_last_error();
    disparity_subscription wanted{};
    const std::uint32_t scan = DISPARITY_PRODUCT_SCAN;
    wanted.products = &scan;
    wanted.product_count = 1;
    ASSERT_EQ(disparity_socket_subscribe(client, &wanted), 0) << disparity_last_error();
    disparity_frame* frame = disparity_frame_new();
    for (int i = 0; i < 4; ++i) {
        const std::int64_t called = proto::monotonic_ns();
        ASSERT_EQ(disparity_socket_read(client, frame, 60'000), DISPARITY_FRAME) << disparity_last_error();
        const std::int64_t returned = proto::monotonic_ns();
        disparity_frame_info info{};
        disparity_frame_get_info(frame, &info, sizeof info);
        EXPECT_GE(info.age_ns, called - captured(info.publish_index));
        EXPECT_LE(info.age_ns, returned - captured(info.publish_index));
        std::this_thread::sleep_for(5 * interval);
    }
    disparity_frame_free(frame);
    disparity_socket_close(client);
}

TEST_F(FreshFramesTest, AddressesMayBeWrittenAsOthersWriteThem) {
    config_.tls = proto::make_server_tls(files_.server(false), "test");
    start();
    const std::string place = tcp_.substr(4);
    EXPECT_NO_THROW(SocketClient("tls://" + place, options()));
    EXPECT_NO_THROW(SocketClient("unix://" + unix_.substr(5)));
    config_.tls = nullptr;
    server_.reset();
    restart();
    EXPECT_NO_THROW(SocketClient("tcp://" + tcp_.substr(4)));
}

TEST_F(FreshFramesTest, TwoThreadsAreTold) {
    start();
    SocketClient client(unix_);
    client.subscribe({.products = {Product::scan}});
    std::string told;
    std::string told_reader;
    std::jthread reader([&] {
        Frame frame;
        try {
            client.read(frame, patience);
        } catch (const std::invalid_argument& error) {
            told_reader = error.what();  // it came second
        }
        done_ = true;
    });
    while (told.empty() && !done_) {
        try {
            client.status(patience);
        } catch (const std::invalid_argument& error) {
            told = error.what();
        }
        std::this_thread::sleep_for(1ms);
    }
    while (!done_) {
        server_->publish(feed_.next());  // the reader's frame
        std::this_thread::sleep_for(1ms);
    }
    reader.join();
    EXPECT_EQ(told.empty() ? told_reader : told,
              "SocketClient: two threads use it at once: give each thread one of its own, or hold a mutex during each "
              "call");
}

TEST_F(FreshFramesTest, AForkIsTold) {
    start();
    SocketClient client(unix_);
    const pid_t child = ::fork();
    if (child == 0) {
        Frame frame;
        try {
            client.read(frame, 0ms);
        } catch (const std::invalid_argument& error) {
            ::_exit(std::string(error.what()).find("before fork()") != std::string::npos ? 17 : 1);
        }
        ::_exit(2);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_EQ(WEXITSTATUS(status), 17);
    EXPECT_FALSE(client.status(patience).empty()) << "the one that made it goes on";
}

}  // namespace
}  // namespace disparityd::test
