// SPDX-License-Identifier: Apache-2.0
#include "capture/recording/recorder.h"

#include <csignal>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/capture/recording/record_fixture.h"

namespace disparityd::capture::test {
namespace {

TEST(Recorder, WritesWhatItIsOffered) {
    const TemporaryFolder folder;
    const SourceInfo info = make_info(PixelFormat::bgr24, 33, 21);
    constexpr int count = 25;
    Recorder recorder(folder.file("r.mkv"), info, count);
    for (int i = 0; i < count; ++i) {
        EXPECT_TRUE(recorder.offer(make_frame(info, i).frame));
    }
    const Recorder::Status status = recorder.finish();
    EXPECT_EQ(status.error, "");
    EXPECT_EQ(status.frames, std::uint64_t{count});
    EXPECT_EQ(status.dropped, 0U);
    EXPECT_EQ(status.bytes, file_bytes(folder.file("r.mkv")).size());
    EXPECT_GT(status.seconds, 0);
    const Replay played = replay(folder.file("r.mkv"));
    EXPECT_EQ(played.error, "");
    ASSERT_EQ(played.frames.size(), std::size_t{count});
    for (int i = 0; i < count; ++i) {
        EXPECT_TRUE(played.frames[static_cast<std::size_t>(i)] == seen(make_frame(info, i).frame));
    }
}

TEST(Recorder, FinishesTwice) {
    const TemporaryFolder folder;
    const SourceInfo info = make_info(PixelFormat::grey8, 8, 8);
    Recorder recorder(folder.file("r.mkv"), info, 4);
    EXPECT_TRUE(recorder.offer(make_frame(info, 0).frame));
    std::thread other([&] { recorder.finish(); });
    const Recorder::Status first = recorder.finish();
    other.join();
    EXPECT_FALSE(recorder.offer(make_frame(info, 1).frame));
    const Recorder::Status second = recorder.finish();
    EXPECT_EQ(first.frames, 1U);
    EXPECT_EQ(second.frames, 1U);
    EXPECT_EQ(second.dropped, 1U);
    EXPECT_EQ(second.bytes, first.bytes);
    EXPECT_EQ(second.seconds, first.seconds);
}

TEST(Recorder, FinishesWhileFramesAreOffered) {
    const TemporaryFolder folder;
    const SourceInfo info = make_info(PixelFormat::yuyv, 32, 24);
    Recorder recorder(folder.file("r.mkv"), info, 3);
    constexpr int count = 300;
    std::uint64_t taken = 0;
    std::thread camera([&] {
        for (int i = 0; i < count; ++i) {
            taken += recorder.offer(make_frame(info, i).frame) ? 1 : 0;
        }
    });
    recorder.finish();
    camera.join();
    const Recorder::Status status = recorder.status();
    EXPECT_EQ(status.frames, taken);
    EXPECT_EQ(status.frames + status.dropped, std::uint64_t{count});
}

TEST(Recorder, WithoutFinishTheFileIsWhole) {
    const TemporaryFolder folder;
    const SourceInfo info = make_info(PixelFormat::grey8, 8, 8);
    {
        Recorder recorder(folder.file("r.mkv"), info);
        EXPECT_TRUE(recorder.offer(make_frame(info, 0).frame));
    }
    const Replay played = replay(folder.file("r.mkv"));
    EXPECT_EQ(played.error, "");
    EXPECT_EQ(played.frames.size(), 1U);
}

TEST(Recorder, FramesOfAnotherSizeAreLost) {
    const TemporaryFolder folder;
    const SourceInfo info = make_info(PixelFormat::grey8, 8, 8);
    Recorder recorder(folder.file("r.mkv"), info);
    EXPECT_FALSE(recorder.offer(make_frame(make_info(PixelFormat::grey8, 8, 9), 0).frame));
    EXPECT_TRUE(recorder.offer(make_frame(info, 1).frame));
    const Recorder::Status status = recorder.finish();
    EXPECT_EQ(status.dropped, 1U);
    const Replay played = replay(folder.file("r.mkv"));
    ASSERT_EQ(played.frames.size(), 1U);
    EXPECT_EQ(played.frames[0].dropped_before, 2U + 1U);
}

TEST(Recorder, RefusesWhatTheWriterRefuses) {
    const TemporaryFolder folder;
    const SourceInfo info = make_info(PixelFormat::grey8, 8, 8);
    write_recording(folder.file("r.mkv"), info, 1);
    EXPECT_THROW(Recorder(folder.file("r.mkv"), info), std::invalid_argument);
    EXPECT_THROW(Recorder(folder.file("none.mkv"), info, 0), std::invalid_argument);
}

/// A disk that takes nothing until it is drained: a pipe.
class SlowDisk {
public:
    explicit SlowDisk(const std::string& path) : path_(path) {
        EXPECT_EQ(mkfifo(path.c_str(), 0600), 0);
        end_ = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
        EXPECT_GE(end_, 0);
    }
    ~SlowDisk() { stop(); }
    SlowDisk(const SlowDisk&) = delete;
    SlowDisk& operator=(const SlowDisk&) = delete;

    void drain() {
        fcntl(end_, F_SETFL, 0);  // from here on, reading waits
        reader_ = std::thread([this] {
            std::vector<std::uint8_t> part(65536);
            for (ssize_t got = 0; (got = read(end_, part.data(), part.size())) > 0;) {
                bytes_.insert(bytes_.end(), part.begin(), part.begin() + got);
            }
        });
    }

    /// Everything written, after the writer closed its end.
    const std::vector<std::uint8_t>& bytes() {
        stop();
        return bytes_;
    }

    /// The disk goes away.
    void unplug() {
        close(end_);
        end_ = -1;
    }

private:
    void stop() {
        if (reader_.joinable()) {
            reader_.join();
        }
        if (end_ >= 0) {
            unplug();
        }
    }

    std::string path_;
    int end_ = -1;
    std::thread reader_;
    std::vector<std::uint8_t> bytes_;
};

TEST(Recorder, ASlowDiskLosesFramesWhichAreCounted) {
    const TemporaryFolder folder;
    SlowDisk disk(folder.file("pipe"));
    const SourceInfo info = make_info(PixelFormat::grey8, 320, 240);
    constexpr std::size_t buffers = 4;
    Recorder recorder(folder.file("pipe"), info, buffers, true);
    // Noise of 150 KB each: the pipe holds 64 KB, the writer half a second. With the disk at a stand, all buffers
    // fill in the end, and from then on every frame is lost.
    int number = 1;
    int in_a_row = 0;
    std::uint64_t taken = 0;
    std::uint64_t lost = 0;
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    for (; in_a_row < 50 && std::chrono::steady_clock::now() < give_up; number += 2) {
        OwnedFrame made = make_frame(info, number);
        made.frame.sequence = 3 * (taken + lost);  // two are lost before each
        if (recorder.offer(made.frame)) {
            ++taken;
            in_a_row = 0;
        } else {
            ++lost;
            ++in_a_row;
        }
    }
    ASSERT_EQ(in_a_row, 50);
    EXPECT_EQ(recorder.status().dropped, lost);
    EXPECT_EQ(recorder.status().lost, 2 * (taken + lost - 1)) << "make_frame() says 2 before each";
    disk.drain();
    while (recorder.status().frames < taken && std::chrono::steady_clock::now() < give_up) {
        std::this_thread::yield();
    }
    OwnedFrame last = make_frame(info, number);
    last.frame.sequence = 3 * (taken + lost);
    ASSERT_TRUE(recorder.offer(last.frame));  // the disk works again
    const Recorder::Status status = recorder.finish();
    EXPECT_EQ(status.error, "");
    EXPECT_EQ(status.frames, taken + 1);
    EXPECT_EQ(status.dropped, lost);

    const auto& bytes = disk.bytes();
    put_file(folder.file("copy.mkv"), bytes.data(), bytes.size());
    const Replay played = replay(folder.file("copy.mkv"));
    ASSERT_EQ(played.frames.size(), status.frames);
    std::uint64_t dropped = 0;
    for (const SeenFrame& frame : played.frames) {
        dropped += frame.dropped_before - 2;  // make_frame() says 2 of each
    }
    EXPECT_EQ(dropped, 3 * lost) << "also those that were lost before a lost one";
    EXPECT_GE(played.frames.back().dropped_before, 52U);
    EXPECT_TRUE(played.frames.back().pixels == seen(last.frame).pixels);
}

TEST(Recorder, ADiskThatGoesAwayIsReported) {
    const auto handler = std::signal(SIGPIPE, SIG_IGN);
    const TemporaryFolder folder;
    SlowDisk disk(folder.file("pipe"));
    const SourceInfo info = make_info(PixelFormat::grey8, 320, 240);
    Recorder recorder(folder.file("pipe"), info, 4, true);
    disk.unplug();
    for (int i = 0; i < 40; ++i) {
        recorder.offer(make_frame(info, i).frame);
    }
    const Recorder::Status status = recorder.finish();
    EXPECT_THAT(status.error, ::testing::HasSubstr("pipe: cannot write: Broken pipe"));
    EXPECT_EQ(status.frames + status.dropped, 40U);
    std::signal(SIGPIPE, handler);
}

}  // namespace
}  // namespace disparityd::capture::test
