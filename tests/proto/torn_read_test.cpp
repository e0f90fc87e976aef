// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <iterator>

#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/proto/collect.h"
#include "tests/proto/pattern.h"

namespace proto = disparityd::proto;
using Result = proto::ShmReader::Result;
using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

namespace {

/// Neighbours in time always differ; only a reader that sleeps through an exact multiple could miss a mixture.
constexpr std::uint64_t prepared = 31;

constexpr auto patience = 60s;
constexpr std::uint64_t enough_frames = 11;

/// What a reader process reports through its pipe: once when it has read enough frames, once at the end.
struct Report {
    std::uint64_t frames = 0;
    std::uint64_t bad = 0;
    std::uint64_t borrowed = 0;     ///< of the frames
    std::uint64_t overwritten = 0;  ///< of those, while they were looked at
};

bool whole(const Collected& got, const proto::ShmLayout& layout) {
    const proto::FrameInfo wanted = pattern::head(got.frame.sequence, layout);
    if (std::memcmp(&got.frame, &wanted, sizeof wanted) != 0) {
        return false;
    }
    for (const auto& [product, bytes] : got.planes) {
        if (!pattern::check_plane(got.frame.sequence, product, bytes).empty()) {
            return false;
        }
    }
    return true;
}

bool send(int out, const Report& report) {
    return ::write(out, &report, sizeof report) == static_cast<ssize_t>(sizeof report);
}

/// Takes a frame in turn by copy and where it lies. `bad` counts mixtures that were not noticed.
Result take(proto::ShmReader& reader, const proto::ShmLayout& layout, Collected& got, Report& report) {
    if (report.frames % 2 == 0) {
        const Result result = got.read(reader, 1s);
        report.frames += result == Result::frame ? 1U : 0U;
        report.bad += result == Result::frame && !whole(got, layout) ? 1U : 0U;
        return result;
    }
    proto::BorrowedSlot slot;
    Collected seen;
    const Result result = reader.borrow(seen.frame, slot, 1s);
    if (result != Result::frame) {
        return result;
    }
    seen.frame.age_ns -= reader.waited_ns();  // as it was published
    ++report.frames;
    ++report.borrowed;
    for (std::uint32_t i = 0; i < slot.view.plane_count; ++i) {
        const proto::ShmPlane& plane = slot.view.planes[i];
        // The check reads the shared memory itself, as a program does that has borrowed it.
        const auto* bytes = reinterpret_cast<const std::uint8_t*>(proto::plane_words(*slot.slot, slot.view, plane));
        seen.planes[plane.product].assign(bytes, bytes + plane.bytes);
    }
    const bool good = whole(seen, layout);
    if (slot.whole()) {
        report.bad += good ? 0U : 1U;
    } else {
        ++report.overwritten;
    }
    return result;
}

/// Reads as fast as it can until the writer closes.
[[noreturn]] void hammer(const std::string& name, const proto::ShmLayout& layout, int out) {
    Report report;
    try {
        proto::ShmReader::Options options;
        options.stale_after = patience;
        proto::ShmReader reader(name, options);
        Collected got;
        Result result = Result::timeout;
        while (result != Result::gone) {
            result = take(reader, layout, got, report);
            if (result == Result::frame && report.frames == enough_frames && !send(out, report)) {
                ::_exit(1);
            }
        }
    } catch (const std::exception& error) {
        std::fprintf(stderr, "reader: %s\n", error.what());
        ++report.bad;
    }
    ::_exit(send(out, report) ? 0 : 1);
}

struct Child {
    pid_t pid = -1;
    int in = -1;

    bool has_reported() const {
        pollfd readable{in, POLLIN, 0};
        return ::poll(&readable, 1, 0) == 1;
    }
};

Child start(const std::string& name, const proto::ShmLayout& layout) {
    int ends[2] = {-1, -1};
    EXPECT_EQ(::pipe(ends), 0);
    const pid_t pid = ::fork();
    if (pid == 0) {
        ::close(ends[0]);
        hammer(name, layout, ends[1]);
    }
    ::close(ends[1]);
    return {pid, ends[0]};
}

TEST(TornRead, NoMixtureOfFramesIsEverSeen) {
    const std::string name = pattern::unique_name("torn", ::getpid());
    const proto::ShmLayout layout = pattern::layout(193, 65);
    // Frames are made beforehand and published in turn, so that the writer is nearly always inside a slot.
    std::vector<pattern::Source> sources(prepared, pattern::Source(layout));
    std::vector<const std::vector<proto::PlaneSource>*> frames;
    for (std::uint64_t sequence = 0; sequence < prepared; ++sequence) {
        frames.push_back(&sources[sequence].make(sequence));
    }
    // Two slots: the writer comes round to a slot as soon as it can, and readers are overtaken all the time.
    proto::SharedMemoryWriter writer(name, layout, 2);
    Child readers[3];
    for (Child& reader : readers) {
        reader = start(name, layout);
    }
    Child victim = start(name, layout);

    std::uint64_t published = 0;
    std::uint64_t kills = 0;
    const auto begin = Clock::now();
    auto kill_at = begin + 40ms;
    // As long as a slow machine needs for what is looked at below.
    const auto all_was_tried = [&] {
        return Clock::now() - begin >= 2500ms && published > 100 && kills > 5 &&
               std::all_of(std::begin(readers), std::end(readers),
                           [](const Child& child) { return child.has_reported(); });
    };
    while (!all_was_tried() && Clock::now() - begin < patience) {
        const std::uint64_t sequence = published++ % prepared;
        writer.publish(pattern::head(sequence, layout), *frames[sequence]);
        writer.heartbeat();
        writer.wake();
        if (Clock::now() >= kill_at) {
            ::kill(victim.pid, SIGKILL);
            ::waitpid(victim.pid, nullptr, 0);
            ::close(victim.in);
            ++kills;
            victim = start(name, layout);
            kill_at = Clock::now() + 40ms;
        }
    }
    writer.close();
    ::kill(victim.pid, SIGKILL);
    ::waitpid(victim.pid, nullptr, 0);
    ::close(victim.in);

    Report sum;
    for (const Child& reader : readers) {
        Report report;
        for (int i = 0; i < 2; ++i) {
            ASSERT_EQ(::read(reader.in, &report, sizeof report), static_cast<ssize_t>(sizeof report));
        }
        ::close(reader.in);
        int status = 0;
        ASSERT_EQ(::waitpid(reader.pid, &status, 0), reader.pid);
        EXPECT_EQ(status, 0);
        EXPECT_EQ(report.bad, 0U);
        EXPECT_GE(report.frames, enough_frames);
        sum.frames += report.frames;
        sum.borrowed += report.borrowed;
        sum.overwritten += report.overwritten;
    }
    EXPECT_GT(published, 100U);
    EXPECT_GT(kills, 5U);
    std::printf(
        "%llu frames written, %llu read, %llu of them borrowed, of which %llu were written over; %llu readers killed\n",
        static_cast<unsigned long long>(published), static_cast<unsigned long long>(sum.frames),
        static_cast<unsigned long long>(sum.borrowed), static_cast<unsigned long long>(sum.overwritten),
        static_cast<unsigned long long>(kills));
}

}  // namespace
