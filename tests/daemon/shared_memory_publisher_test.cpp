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

TEST(SharedMemoryPublisher, WakesMoreReadersThanThePublishingThreadDoes) {
    constexpr int width = 16;
    constexpr int height = 4;
    constexpr int readers = 50;
    const std::vector<std::uint8_t> pixels(width * height, 7);
    StreamLayout layout;
    layout.geometry.width = width;
    layout.geometry.height = height;
    layout.products = {v1::CONFIDENCE};
    PublishedFrame frame;
    frame.planes[0] = {pixels.data(), width, height, width};
    const std::string name = "publisher-test-" + std::to_string(getpid());
    SharedMemoryPublisher publisher(name, layout, 4);

    std::atomic<int> got{0};
    std::vector<std::thread> threads;
    threads.reserve(readers);
    for (int i = 0; i < readers; ++i) {
        threads.emplace_back([&] {
            // Looks by itself only after the time is up: whoever gets the frame was woken, or came after it.
            proto::ShmReader::Options options;
            options.check_every = 240s;
            proto::ShmReader reader(name, options);
            proto::FrameInfo head{};
            proto::BorrowedSlot slot;
            if (reader.borrow(head, slot, 120s) == proto::ShmReader::Result::frame) {
                got.fetch_add(1);
            }
        });
    }
    std::this_thread::sleep_for(200ms);  // not needed to pass: makes it likely that all readers sleep already
    publisher.publish(frame);
    for (std::thread& thread : threads) {
        thread.join();
    }
    EXPECT_EQ(got.load(), readers);
}

}  // namespace
}  // namespace disparityd::daemon
