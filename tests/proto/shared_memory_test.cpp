// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <fstream>
#include <stdexcept>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/proto/collect.h"
#include "tests/proto/pattern.h"

namespace proto = disparityd::proto;
using Result = proto::ShmReader::Result;
using namespace std::chrono_literals;

namespace {

constexpr auto plenty = 60s;
constexpr auto rarely = 2 * plenty;

class SharedMemory : public testing::Test {
protected:
    std::string name_ = pattern::unique_name("unit", ::getpid());
    proto::ShmLayout layout_ = pattern::layout();

    void publish(proto::SharedMemoryWriter& writer, std::uint64_t sequence, bool outdated = false) {
        pattern::Source source(layout_);
        writer.publish(pattern::head(sequence, layout_), source.make(sequence), proto::monotonic_ns(), outdated);
    }

    void expect_frame(const Collected& got, std::uint64_t sequence) {
        const proto::FrameInfo wanted = pattern::head(sequence, layout_);
        EXPECT_EQ(std::memcmp(&got.frame, &wanted, sizeof wanted), 0) << "frame " << got.frame.sequence;
        ASSERT_EQ(got.planes.size(), layout_.planes.size());
        for (const auto& [product, bytes] : got.planes) {
            EXPECT_EQ(pattern::check_plane(sequence, product, bytes), "");
        }
    }
};

// The first frame that a reader finds may be the last one of a source that has ended, or of a daemon that was stopped.
TEST_F(SharedMemory, AnAgeCountsUntilTheFrameIsRead) {
    proto::SharedMemoryWriter writer(name_, layout_);
    pattern::Source source(layout_);
    proto::FrameInfo head = pattern::head(1, layout_);
    head.age_ns = 9'000'000;
    const std::int64_t published = proto::monotonic_ns() - 40'000'000'000;
    writer.publish(head, source.make(1), published);
    proto::ShmReader copying(name_);
    proto::ShmReader borrowing(name_);
    proto::FrameInfo copied{};
    proto::FrameInfo borrowed{};
    proto::BorrowedSlot slot;
    const std::int64_t called = proto::monotonic_ns();
    ASSERT_EQ(copying.read(
                  copied, [](const proto::ShmPlane&) { return nullptr; }, 0ms),
              Result::frame);
    ASSERT_EQ(borrowing.borrow(borrowed, slot, 0ms), Result::frame);
    const std::int64_t returned = proto::monotonic_ns();
    for (const proto::FrameInfo& frame : {copied, borrowed}) {
        EXPECT_GE(frame.age_ns, called - published + 9'000'000);
        EXPECT_LE(frame.age_ns, returned - published + 9'000'000);
    }
    EXPECT_EQ(copied.age_ns - copying.waited_ns(), 9'000'000);
}

// A daemon of before.
TEST_F(SharedMemory, WithoutATimeOfPublishingTheAgeIsThatOfThePublisher) {
    proto::SharedMemoryWriter writer(name_, layout_);
    pattern::Source source(layout_);
    const proto::FrameInfo head = pattern::head(1, layout_);
    writer.publish(head, source.make(1), 0);
    proto::ShmReader reader(name_);
    proto::FrameInfo frame{};
    ASSERT_EQ(reader.read(
                  frame, [](const proto::ShmPlane&) { return nullptr; }, 0ms),
              Result::frame);
    EXPECT_EQ(frame.age_ns, head.age_ns);
    EXPECT_EQ(reader.waited_ns(), 0);
}

TEST_F(SharedMemory, FrameArrivesWholeAndOnce) {
    proto::SharedMemoryWriter writer(name_, layout_);
    EXPECT_EQ(writer.note(), "");
    EXPECT_EQ(writer.object_name(), "/disparityd." + name_);
    proto::ShmReader reader(name_);
    Collected got;
    EXPECT_EQ(got.read(reader, 0ms), Result::timeout);
    publish(writer, 5);
    ASSERT_EQ(got.read(reader, 0ms), Result::frame);
    expect_frame(got, 5);
    EXPECT_EQ(got.read(reader, 0ms), Result::timeout);
    for (std::uint64_t sequence = 6; sequence < 20; ++sequence) {
        publish(writer, sequence);
    }
    ASSERT_EQ(got.read(reader, 0ms), Result::frame);
    expect_frame(got, 19);
}

TEST_F(SharedMemory, AnOutdatedFrameIsNotReadAnyMore) {
    proto::SharedMemoryWriter writer(name_, layout_);
    proto::ShmReader before(name_);
    Collected got;
    publish(writer, 1);
    ASSERT_EQ(got.read(before, 0ms), Result::frame);
    publish(writer, 2);
    writer.outdate();
    proto::ShmReader after(name_);
    EXPECT_EQ(got.read(before, 0ms), Result::timeout);
    EXPECT_EQ(got.read(after, 0ms), Result::timeout);
    publish(writer, 3);
    for (proto::ShmReader* reader : {&before, &after}) {
        ASSERT_EQ(got.read(*reader, 0ms), Result::frame);
        expect_frame(got, 3);
    }
}

TEST_F(SharedMemory, AFrameThatIsPublishedAsOldIsNotRead) {
    proto::SharedMemoryWriter writer(name_, layout_);
    proto::ShmReader reader(name_);
    Collected got;
    publish(writer, 1, true);
    EXPECT_EQ(got.read(reader, 0ms), Result::timeout);
    publish(writer, 2);
    ASSERT_EQ(got.read(reader, 0ms), Result::frame);
    expect_frame(got, 2);
}

TEST_F(SharedMemory, ABorrowedFrameIsWholeUntilTheRingComesRound) {
    constexpr std::uint32_t slots = 3;
    proto::SharedMemoryWriter writer(name_, layout_, slots);
    proto::ShmReader reader(name_);
    proto::FrameInfo frame{};
    proto::BorrowedSlot slot;
    EXPECT_EQ(reader.borrow(frame, slot, 0ms), Result::timeout);
    EXPECT_FALSE(slot.whole());
    publish(writer, 5);
    ASSERT_EQ(reader.borrow(frame, slot, 0ms), Result::frame);
    EXPECT_EQ(frame.sequence, 5U);
    for (std::uint32_t later = 1; later < slots; ++later) {
        publish(writer, 5 + later);
        EXPECT_TRUE(slot.whole());
    }
    publish(writer, 5 + slots);
    EXPECT_FALSE(slot.whole());
    publish(writer, 6 + slots);
    ASSERT_EQ(reader.borrow(frame, slot, 0ms), Result::frame);
    EXPECT_EQ(frame.sequence, 6 + slots);
    EXPECT_TRUE(slot.whole());
    EXPECT_EQ(reader.borrow(frame, slot, 0ms), Result::timeout);
    EXPECT_FALSE(slot.whole()) << "the frame before was given up";
}

TEST_F(SharedMemory, LateReaderGetsTheNewestFrame) {
    proto::SharedMemoryWriter writer(name_, layout_);
    publish(writer, 1);
    proto::ShmReader reader(name_);
    Collected got;
    ASSERT_EQ(got.read(reader, 0ms), Result::frame);
    expect_frame(got, 1);
}

TEST_F(SharedMemory, ModeIs0640WhateverTheUmask) {
    const mode_t before = ::umask(0);
    proto::SharedMemoryWriter writer(name_, layout_);
    ::umask(before);
    struct stat info {};
    ASSERT_EQ(::stat(("/dev/shm" + writer.object_name()).c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 0777, 0640U);
}

TEST_F(SharedMemory, WaitingReaderIsWokenByTheFutex) {
    proto::SharedMemoryWriter writer(name_, layout_);
    // Looks by itself only now and then: what comes before its time is up was woken.
    proto::ShmReader::Options options;
    options.check_every = rarely;
    proto::ShmReader reader(name_, options);
    Collected got;
    Result result = Result::timeout;
    const auto begin = std::chrono::steady_clock::now();
    std::thread waiting([&] { result = got.read(reader, plenty); });
    std::this_thread::sleep_for(50ms);  // not needed to pass: makes it likely that the reader sleeps already
    publish(writer, 3);
    writer.wake();
    waiting.join();
    EXPECT_EQ(result, Result::frame);
    EXPECT_LT(std::chrono::steady_clock::now() - begin, plenty);
}

TEST_F(SharedMemory, TimeoutIsKept) {
    proto::SharedMemoryWriter writer(name_, layout_);
    proto::ShmReader reader(name_);
    Collected got;
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_EQ(got.read(reader, 80ms), Result::timeout);
    const auto waited = std::chrono::steady_clock::now() - begin;
    EXPECT_GE(waited, 79ms);
    EXPECT_LT(waited, plenty);
}

TEST_F(SharedMemory, CloseWakesReadersAndRemovesTheName) {
    auto writer = std::make_unique<proto::SharedMemoryWriter>(name_, layout_);
    proto::ShmReader::Options options;
    options.check_every = rarely;
    proto::ShmReader reader(name_, options);
    Collected got;
    Result result = Result::frame;
    const auto begin = std::chrono::steady_clock::now();
    std::thread waiting([&] { result = got.read(reader, plenty); });
    std::this_thread::sleep_for(50ms);  // as above
    writer.reset();
    waiting.join();
    EXPECT_EQ(result, Result::gone);
    EXPECT_LT(std::chrono::steady_clock::now() - begin, plenty);
    EXPECT_THROW(proto::ShmReader again(name_), std::runtime_error);
    EXPECT_EQ(reader.heartbeat_age(), std::chrono::nanoseconds::max());

    // A daemon that comes back is found by the same reader.
    proto::SharedMemoryWriter next(name_, layout_);
    publish(next, 8);
    ASSERT_EQ(got.read(reader, 0ms), Result::frame);
    expect_frame(got, 8);
}

TEST_F(SharedMemory, WriterWithoutHeartbeatIsGoneUntilItBeatsAgain) {
    proto::SharedMemoryWriter writer(name_, layout_);
    proto::ShmReader::Options options;
    options.stale_after = 50ms;
    options.check_every = 5ms;
    proto::ShmReader reader(name_, options);
    Collected got;
    EXPECT_EQ(got.read(reader, 20s), Result::gone);
    EXPECT_GT(reader.heartbeat_age(), 50ms);
    publish(writer, 2);
    writer.heartbeat();
    EXPECT_EQ(got.read(reader, 20s), Result::frame);
}

TEST_F(SharedMemory, ReadersFollowANewLayout) {
    proto::SharedMemoryWriter writer(name_, layout_);
    publish(writer, 1);
    proto::ShmReader reader(name_);
    Collected got;
    ASSERT_EQ(got.read(reader, 0ms), Result::frame);
    layout_ = {100, 50, {{4, 1}}};
    writer.relayout(layout_);
    EXPECT_EQ(got.read(reader, 0ms), Result::timeout);
    EXPECT_EQ(reader.view().width, 100U);
    publish(writer, 2);
    got.planes.clear();
    ASSERT_EQ(got.read(reader, 0ms), Result::frame);
    expect_frame(got, 2);

    // A layout that is refused leaves the object as it is.
    EXPECT_THROW(writer.relayout({0, 50, {{4, 1}}}), std::invalid_argument);
    EXPECT_THROW(writer.relayout(layout_, 1), std::invalid_argument);
    publish(writer, 3);
    ASSERT_EQ(got.read(reader, 0ms), Result::frame);
    expect_frame(got, 3);
}

TEST_F(SharedMemory, ReadersFollowAnotherNumberOfSlots) {
    proto::SharedMemoryWriter writer(name_, layout_, 4);
    proto::ShmReader reader(name_);
    Collected got;
    for (const std::uint32_t slots : {8U, 2U}) {
        writer.relayout(layout_, slots);
        EXPECT_EQ(got.read(reader, 0ms), Result::timeout) << "the daemon is not gone";
        EXPECT_EQ(reader.view().slot_count, slots);
        writer.relayout(layout_);
        EXPECT_EQ(got.read(reader, 0ms), Result::timeout);
        EXPECT_EQ(reader.view().slot_count, slots) << "it stays";
    }
}

TEST_F(SharedMemory, SleepingReaderFollowsANewLayout) {
    proto::SharedMemoryWriter writer(name_, layout_);
    proto::ShmReader::Options options;
    options.check_every = rarely;
    proto::ShmReader reader(name_, options);
    Collected got;
    Result result = Result::gone;
    const auto begin = std::chrono::steady_clock::now();
    std::thread waiting([&] { result = got.read(reader, plenty); });
    layout_ = {64, 64, {{1, 2}}};
    writer.relayout(layout_);
    publish(writer, 4);
    writer.wake();
    waiting.join();
    EXPECT_EQ(result, Result::frame);
    EXPECT_EQ(got.frame.sequence, 4U);
    EXPECT_LT(std::chrono::steady_clock::now() - begin, plenty);
}

TEST_F(SharedMemory, PublishRefusesPlanesThatAreNotOfTheLayout) {
    proto::SharedMemoryWriter writer(name_, layout_);
    pattern::Source source(layout_);
    auto planes = source.make(1);
    planes[1].row_bytes -= 1;
    EXPECT_THROW(writer.publish(pattern::head(1, layout_), planes), std::invalid_argument);
    planes = source.make(1);
    planes.pop_back();
    EXPECT_THROW(writer.publish(pattern::head(1, layout_), planes), std::invalid_argument);
    proto::ShmReader reader(name_);
    Collected got;
    EXPECT_EQ(got.read(reader, 0ms), Result::timeout);
    publish(writer, 2);
    EXPECT_EQ(got.read(reader, 0ms), Result::frame);
}

TEST_F(SharedMemory, MorePlanesThanVersion1Has) {
    layout_ = pattern::layout(64, 32);
    for (std::uint32_t product = 10; layout_.planes.size() < proto::shm_max_planes; ++product) {
        layout_.planes.push_back({product, 1});
        proto::SharedMemoryWriter writer(name_, layout_);
        proto::ShmReader reader(name_);
        publish(writer, product);
        Collected got;
        ASSERT_EQ(got.read(reader, 0ms), Result::frame);
        expect_frame(got, product);
    }
    layout_.planes.push_back({100, 1});
    EXPECT_THROW(proto::SharedMemoryWriter(name_, layout_), std::invalid_argument);
}

TEST_F(SharedMemory, NamesAndLayoutsOutsideTheLimitsAreRefused) {
    for (const std::string name : {"", "a/b", "..\n", "a b", "\xc3\xa4"}) {
        EXPECT_THROW(proto::SharedMemoryWriter(name, layout_), std::invalid_argument) << name;
        EXPECT_THROW(proto::ShmReader reader(name), std::invalid_argument) << name;
    }
    EXPECT_THROW(proto::SharedMemoryWriter(name_, {16385, 10, {{1, 2}}}), std::invalid_argument);
    EXPECT_THROW(proto::SharedMemoryWriter(name_, {10, 10, {{1, 2}, {1, 2}}}), std::invalid_argument);
    EXPECT_THROW(proto::SharedMemoryWriter(name_, {10, 10, {{1, 0}}}), std::invalid_argument);
    EXPECT_THROW(proto::SharedMemoryWriter(name_, layout_, 1), std::invalid_argument);
}

TEST_F(SharedMemory, LivingDaemonKeepsItsName) {
    proto::SharedMemoryWriter writer(name_, layout_);
    try {
        proto::SharedMemoryWriter second(name_, layout_);
        FAIL() << "accepted";
    } catch (const std::runtime_error& error) {
        EXPECT_EQ(std::string(error.what()), "shared memory /disparityd." + name_ + " is in use by process " +
                                                 std::to_string(::getpid()) +
                                                 ": stop it or choose another name with [shared_memory] name");
    }
    publish(writer, 1);
    proto::ShmReader reader(name_);
    Collected got;
    EXPECT_EQ(got.read(reader, 0ms), Result::frame);
}

TEST_F(SharedMemory, LeftoverOfAKilledDaemonIsReplacedAndItsReadersMoveOn) {
    const pid_t daemon = ::fork();
    if (daemon == 0) {
        proto::SharedMemoryWriter writer(name_, layout_);
        publish(writer, 1);
        ::raise(SIGKILL);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(daemon, &status, 0), daemon);
    ASSERT_TRUE(WIFSIGNALED(status));

    proto::ShmReader reader(name_);
    Collected got;
    ASSERT_EQ(got.read(reader, 0ms), Result::frame);

    proto::SharedMemoryWriter writer(name_, layout_);
    EXPECT_THAT(writer.note(), testing::HasSubstr("left behind by process " + std::to_string(daemon)));
    EXPECT_EQ(got.read(reader, 0ms), Result::timeout);
    publish(writer, 9);
    ASSERT_EQ(got.read(reader, 0ms), Result::frame);
    expect_frame(got, 9);
}

TEST_F(SharedMemory, ReadersCannotWrite) {
    proto::SharedMemoryWriter writer(name_, layout_);
    proto::ShmReader reader(name_);
    // The process has two mappings of the object, the writer's and the reader's.
    std::ifstream maps("/proc/self/maps");
    std::string line;
    std::vector<std::uintptr_t> read_only;
    while (std::getline(maps, line)) {
        if (line.find("disparityd." + name_) != std::string::npos && line.find("r--s") != std::string::npos) {
            read_only.push_back(std::stoull(line.substr(0, line.find('-')), nullptr, 16));
        }
    }
    ASSERT_EQ(read_only.size(), 1U);
    const pid_t child = ::fork();
    if (child == 0) {
        ::signal(SIGSEGV, SIG_DFL);
        *reinterpret_cast<volatile char*>(read_only.front()) = 1;
        ::_exit(0);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGSEGV) << status;
}

}  // namespace
