// SPDX-License-Identifier: Apache-2.0
//
// What readers do while their daemon is away, and what the daemon does when its object has lost its name.
#include <chrono>
#include <filesystem>
#include <stdexcept>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/proto/collect.h"
#include "tests/proto/pattern.h"

namespace proto = disparityd::proto;
using Result = proto::ShmReader::Result;
using namespace std::chrono_literals;
using testing::HasSubstr;

namespace {

class MemoryReturn : public testing::Test {
protected:
    std::string name_ = pattern::unique_name("return", ::getpid());
    proto::ShmLayout layout_ = pattern::layout(64, 32);
    Collected got_;

    void TearDown() override { remove_name(); }

    void remove_name() { ::shm_unlink(("/disparityd." + name_).c_str()); }

    void publish(proto::SharedMemoryWriter& writer, std::uint64_t sequence) {
        pattern::Source source(layout_);
        writer.publish(pattern::head(sequence, layout_), source.make(sequence));
    }
};

// Else a loop that reads on would take a whole core until the daemon is back.
TEST_F(MemoryReturn, TheFirstGoneComesAtOnceTheNextOnesAfterTheTimeout) {
    auto writer = std::make_unique<proto::SharedMemoryWriter>(name_, layout_);
    proto::ShmReader reader(name_);
    writer.reset();
    EXPECT_EQ(got_.read(reader, 60s), Result::gone);
    EXPECT_THAT(reader.why_gone(), HasSubstr("shared memory /disparityd." + name_ + ": there is none"));
    for (int i = 0; i < 3; ++i) {
        const auto begin = std::chrono::steady_clock::now();
        EXPECT_EQ(got_.read(reader, 80ms), Result::gone);
        EXPECT_GE(std::chrono::steady_clock::now() - begin, 79ms);
    }
    EXPECT_EQ(got_.read(reader, 0ms), Result::gone);
}

TEST_F(MemoryReturn, AReaderThatWaitsGetsTheFramesOfTheNextDaemon) {
    auto writer = std::make_unique<proto::SharedMemoryWriter>(name_, layout_);
    proto::ShmReader reader(name_);
    for (std::uint64_t round = 1; round <= 2; ++round) {
        writer.reset();
        EXPECT_EQ(got_.read(reader, 60s), Result::gone) << "told at once, each time";
        std::thread next([&] {
            writer = std::make_unique<proto::SharedMemoryWriter>(name_, layout_);
            publish(*writer, round);
            writer->wake();
        });
        EXPECT_EQ(got_.read(reader, 60s), Result::frame);
        EXPECT_EQ(got_.frame.sequence, round);
        next.join();
    }
}

TEST_F(MemoryReturn, ADeadDaemonIsWaitedForToo) {
    auto writer = std::make_unique<proto::SharedMemoryWriter>(name_, layout_);
    proto::ShmReader::Options options;
    options.stale_after = 50ms;
    options.check_every = 5ms;
    proto::ShmReader reader(name_, options);
    EXPECT_EQ(got_.read(reader, 60s), Result::gone);
    EXPECT_THAT(reader.why_gone(), HasSubstr("no heartbeat"));
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_EQ(got_.read(reader, 80ms), Result::gone);
    EXPECT_GE(std::chrono::steady_clock::now() - begin, 79ms);
    std::thread revived([&] {
        writer->heartbeat();
        publish(*writer, 4);
    });
    EXPECT_EQ(got_.read(reader, 60s), Result::frame);
    revived.join();
}

TEST_F(MemoryReturn, AReaderMayBeThereBeforeTheDaemon) {
    EXPECT_THROW(proto::ShmReader reader(name_), std::runtime_error);
    proto::ShmReader::Options options;
    options.may_be_absent = true;
    proto::ShmReader reader(name_, options);
    EXPECT_THAT(reader.why_gone(), HasSubstr("there is none: is disparityd running"));
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_EQ(got_.read(reader, 80ms), Result::gone);
    EXPECT_GE(std::chrono::steady_clock::now() - begin, 79ms);
    proto::SharedMemoryWriter writer(name_, layout_);
    publish(writer, 1);
    EXPECT_EQ(got_.read(reader, 60s), Result::frame);
}

TEST_F(MemoryReturn, AnObjectWithoutItsNameIsMadeAnewAndReadersMoveOver) {
    proto::SharedMemoryWriter writer(name_, layout_);
    proto::ShmReader reader(name_);
    publish(writer, 1);
    ASSERT_EQ(got_.read(reader, 0ms), Result::frame);
    EXPECT_TRUE(writer.has_name());
    writer.restore();
    publish(writer, 2);
    ASSERT_EQ(got_.read(reader, 0ms), Result::frame) << "nothing was lost, nothing is made anew";

    remove_name();
    EXPECT_FALSE(writer.has_name());
    EXPECT_THROW(proto::ShmReader late(name_), std::runtime_error);
    writer.restore();
    EXPECT_TRUE(writer.has_name());
    proto::ShmReader late(name_);
    EXPECT_EQ(got_.read(reader, 0ms), Result::timeout);
    publish(writer, 3);
    ASSERT_EQ(got_.read(reader, 0ms), Result::frame);
    EXPECT_EQ(got_.frame.sequence, 3U);
    ASSERT_EQ(got_.read(late, 0ms), Result::frame);
}

// Tells of races where there are some: with the thread sanitizer, and by frames that the reader misses for ever.
TEST_F(MemoryReturn, ItIsMadeAnewWhileFramesArePublished) {
    proto::SharedMemoryWriter writer(name_, layout_);
    proto::ShmReader reader(name_);
    std::atomic<bool> stop{false};
    std::thread publisher([&] {
        for (std::uint64_t sequence = 1; !stop; ++sequence) {
            publish(writer, sequence);
            writer.wake();
            writer.heartbeat();
        }
    });
    std::uint64_t last = 0;
    for (int i = 0; i < 20; ++i) {
        remove_name();
        writer.restore();
        for (int frames = 0; frames < 3; ++frames) {
            EXPECT_EQ(got_.read(reader, 60s), Result::frame);
            EXPECT_GT(got_.frame.sequence, last);
            last = got_.frame.sequence;
            for (const auto& [product, bytes] : got_.planes) {
                EXPECT_EQ(pattern::check_plane(last, product, bytes), "");
            }
        }
    }
    stop = true;
    publisher.join();
}

// Two daemons: the one that has lost its name does not take it from the other, whatever it does.
TEST_F(MemoryReturn, ANameThatAnotherDaemonHasTakenIsLeftAlone) {
    auto first = std::make_unique<proto::SharedMemoryWriter>(name_, layout_);
    remove_name();
    proto::SharedMemoryWriter second(name_, layout_);
    EXPECT_FALSE(first->has_name());
    EXPECT_THROW(first->restore(), std::runtime_error);
    EXPECT_THROW(first->relayout(pattern::layout(32, 16)), std::runtime_error);
    publish(*first, 1);
    first.reset();
    EXPECT_TRUE(second.has_name());
    proto::ShmReader reader(name_);
    publish(second, 2);
    ASSERT_EQ(got_.read(reader, 0ms), Result::frame);
    EXPECT_EQ(got_.frame.sequence, 2U);
}

TEST_F(MemoryReturn, NoTemporaryObjectIsLeftBehind) {
    {
        proto::SharedMemoryWriter writer(name_, layout_);
        writer.relayout(pattern::layout(32, 16));
        remove_name();
        proto::SharedMemoryWriter second(name_, layout_);
        EXPECT_THROW(writer.restore(), std::runtime_error);
    }
    for (const auto& entry : std::filesystem::directory_iterator("/dev/shm")) {
        EXPECT_THAT(entry.path().string(), testing::Not(HasSubstr("disparityd." + name_)));
    }
}

}  // namespace
