// SPDX-License-Identifier: Apache-2.0
#include "daemon/shared_memory_publisher.h"

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include "proto/futex.h"
#include "proto/mapping.h"
#include "proto/shared_memory.h"
#include "proto/shared_memory_reader.h"

namespace disparityd::daemon {
namespace {

using namespace std::chrono_literals;

constexpr int published_width = 16;
constexpr int published_height = 4;

StreamLayout one_product() {
    StreamLayout layout;
    layout.geometry.width = published_width;
    layout.geometry.height = published_height;
    layout.products = {v1::CONFIDENCE};
    return layout;
}

class SharedMemoryPublisherTest : public testing::Test {
protected:
    SharedMemoryPublisherTest() {
        frame_.planes[0] = {pixels_.data(), published_width, published_height, published_width};
    }

    /// A reader looks by itself only after the time of the test is up: whoever gets a frame was woken, or came after
    /// it.
    static proto::ShmReader::Options only_when_woken() {
        proto::ShmReader::Options options;
        options.check_every = 240s;
        return options;
    }

    const std::vector<std::uint8_t> pixels_ = std::vector<std::uint8_t>(published_width * published_height, 7);
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
            // Looks by itself only after the time is up: whoever gets the frame was woken, or came after it.
            proto::ShmReader::Options options;
            options.check_every = 240s;
            proto::ShmReader reader(name_, options);
            proto::FrameInfo head{};
            proto::BorrowedSlot slot;
            if (reader.borrow(head, slot, 120s) == proto::ShmReader::Result::frame) {
                got.fetch_add(1);
            }
        });
    }
    std::this_thread::sleep_for(200ms);  // not needed to pass: makes it likely that all readers sleep already
    publisher_.publish(frame_, false);
    for (std::thread& thread : threads) {
        thread.join();
    }
    EXPECT_EQ(got.load(), readers);
}

TEST_F(SharedMemoryPublisherTest, KnowsOfAReaderThatNeverWaits) {
    EXPECT_FALSE(publisher_.has_reader());
    {
        const proto::ShmReader first(name_);
        const proto::ShmReader second(name_);
        EXPECT_TRUE(publisher_.has_reader());
    }
    EXPECT_FALSE(publisher_.has_reader());
    const proto::ShmReader late(name_);
    StreamLayout other = one_product();
    other.geometry.width = 2 * published_width;
    publisher_.relayout(other, 4);
    EXPECT_FALSE(publisher_.has_reader()) << "it has not mapped the new object yet";
}

// One that is written after docs/protocol.md, or the library of before, does not lock.
TEST_F(SharedMemoryPublisherTest, KnowsOfAReaderThatWaitsWithoutALock) {
    const proto::Descriptor file(::shm_open(publisher_.object_name().c_str(), O_RDONLY, 0));
    ASSERT_GE(file.get(), 0);
    const proto::Mapping memory(file, sizeof(proto::ShmHeader), PROT_READ);
    ASSERT_TRUE(memory);
    publisher_.publish(frame_, false);
    EXPECT_FALSE(publisher_.has_reader()) << "nobody waited for the frame";
    const auto& published = memory.start<const proto::ShmHeader>().published;
    std::thread reader([&] { proto::futex_wait(published, published.load(), 120s); });
    while (!publisher_.has_reader()) {
        std::this_thread::yield();
    }
    reader.join();
    EXPECT_TRUE(publisher_.has_reader()) << "it may work on a frame";
}

}  // namespace
}  // namespace disparityd::daemon
