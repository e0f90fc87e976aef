// SPDX-License-Identifier: Apache-2.0
#include "daemon/shared_memory_publisher.h"

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "proto/shared_memory_reader.h"

namespace disparityd::daemon {
namespace {

using namespace std::chrono_literals;

constexpr int width = 16;
constexpr int height = 4;

StreamLayout one_product() {
    StreamLayout layout;
    layout.geometry.width = width;
    layout.geometry.height = height;
    layout.products = {v1::CONFIDENCE};
    return layout;
}

class SharedMemoryPublisherTest : public testing::Test {
protected:
    SharedMemoryPublisherTest() { frame_.planes[0] = {pixels_.data(), width, height, width}; }

    /// A reader looks by itself only after the time of the test is up: whoever gets a frame was woken, or came after
    /// it.
    static proto::ShmReader::Options only_when_woken() {
        proto::ShmReader::Options options;
        options.check_every = 240s;
        return options;
    }

    const std::vector<std::uint8_t> pixels_ = std::vector<std::uint8_t>(width * height, 7);
    const std::string name_ = "publisher-test-" + std::to_string(getpid());
    PublishedFrame frame_;
    SharedMemoryPublisher publisher_{name_, one_product(), 4};
};

TEST_F(SharedMemoryPublisherTest, WakesMoreReadersThanThePublishingThreadDoes) {
    constexpr int readers = 50;
    std::atomic<int> got{0};
    std::vector<std::thread> threads;
    threads.reserve(readers);
    for (int i = 0; i < readers; ++i) {
        threads.emplace_back([&] {
            proto::ShmReader reader(name_, only_when_woken());
            proto::FrameInfo head{};
            proto::BorrowedSlot slot;
            if (reader.borrow(head, slot, 120s) == proto::ShmReader::Result::frame) {
                got.fetch_add(1);
            }
        });
    }
    std::this_thread::sleep_for(200ms);  // not needed to pass: makes it likely that all readers sleep already
    publisher_.publish(frame_);
    for (std::thread& thread : threads) {
        thread.join();
    }
    EXPECT_EQ(got.load(), readers);
}

// Frames pass as the capture thread asks for each of them: it is published or, when nobody waits, outdates those
// before.
TEST_F(SharedMemoryPublisherTest, AReaderThatWaitsGetsTheFrameForWhichItIsFoundWaiting) {
    EXPECT_FALSE(publisher_.has_reader());
    frame_.info.publish_index = 1;
    publisher_.publish(frame_);
    EXPECT_FALSE(publisher_.has_reader()) << "nobody waited for it";
    publisher_.outdate();
    std::atomic<std::uint64_t> read{0};
    std::thread reader([&] {
        proto::ShmReader memory(name_, only_when_woken());
        proto::FrameInfo head{};
        proto::BorrowedSlot slot;
        if (memory.borrow(head, slot, 120s) == proto::ShmReader::Result::frame) {
            read = head.publish_index;
        }
    });
    while (!publisher_.has_reader()) {
        std::this_thread::yield();
    }
    frame_.info.publish_index = 2;
    publisher_.publish(frame_);
    reader.join();
    EXPECT_EQ(read.load(), 2U);
    EXPECT_TRUE(publisher_.has_reader()) << "it may work on the frame";
}

}  // namespace
}  // namespace disparityd::daemon
