// SPDX-License-Identifier: Apache-2.0
// Recordings whose writer was killed, whose disk was full, or whose end is missing.
#include <algorithm>
#include <csignal>
#include <stdexcept>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "capture/recording/recorder.h"
#include "capture/recording/recording_segment.h"
#include "capture/recording/recording_writer.h"
#include "tests/capture/recording/file_size_limit.h"
#include "tests/capture/recording/record_fixture.h"

namespace disparityd::capture::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

void expect_beginning(const std::vector<SeenFrame>& frames, const SourceInfo& info) {
    for (std::size_t i = 0; i < frames.size(); ++i) {
        EXPECT_TRUE(frames[i] == seen(make_frame(info, static_cast<int>(i)).frame)) << "frame " << i;
    }
}

TEST(RecordDamage, CutAnywhereItPlaysWhatIsWholeAndSaysSo) {
    const TemporaryFolder folder;
    const std::string path = folder.file("whole.mkv");
    const std::string cut = folder.file("cut.mkv");
    const SourceInfo info = make_info(PixelFormat::yuyv, 16, 12);
    constexpr int count = 40;
    write_recording(path, info, count);
    const std::vector<std::uint8_t> bytes = file_bytes(path);

    std::size_t most = 0;
    std::size_t refused = 0;
    for (std::size_t size = 1; size < bytes.size(); size += size < 1500 ? 13 : 97) {
        SCOPED_TRACE(size);
        put_file(cut, bytes.data(), size);
        try {
            const Replay played = replay(cut);
            ASSERT_THAT(played.error, AllOf(StartsWith(cut + ": truncated: "), HasSubstr(" could be read"),
                                            HasSubstr(std::to_string(played.frames.size()) + " ")));
            EXPECT_EQ(std::count(played.error.begin(), played.error.end(), '\n'), 0);
            expect_beginning(played.frames, info);
            EXPECT_GE(played.frames.size(), most);
            most = played.frames.size();
        } catch (const std::invalid_argument& error) {
            EXPECT_THAT(error.what(), StartsWith(cut + ": "));
            EXPECT_EQ(most, 0U) << "a shorter file could be opened";
            ++refused;
        }
    }
    EXPECT_GT(refused, 0U);
    EXPECT_EQ(most, std::size_t{count});  // cut inside the index, after the last frame
}

// The numbers of frames count on, so that what the damage has swallowed is known.
TEST(RecordDamage, FramesThatAreMissingInsideCountAsLost) {
    const TemporaryFolder folder;
    const std::string path = folder.file("whole.mkv");
    const std::string holed = folder.file("holed.mkv");
    write_recording(path, make_info(PixelFormat::yuyv, 16, 12), 40);
    const std::vector<std::uint8_t> whole = file_bytes(path);
    std::size_t gaps = 0;
    for (std::size_t at = whole.size() / 3; at < whole.size() * 2 / 3; at += 397) {
        SCOPED_TRACE(at);
        std::vector<std::uint8_t> bytes = whole;
        std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), bytes.size() / 8, std::uint8_t{0x55});
        put_file(holed, bytes.data(), bytes.size());
        const Replay played = replay(holed);
        EXPECT_THAT(played.error, HasSubstr("of 40 frames"));
        for (std::size_t i = 1; i < played.frames.size(); ++i) {
            const SeenFrame& frame = played.frames[i];
            EXPECT_EQ(frame.sequence, played.frames[i - 1].sequence + 1 + frame.dropped_before);
            gaps += frame.dropped_before > 2 ? 1U : 0U;
        }
    }
    EXPECT_GT(gaps, 0U) << "no reader went on behind a hole";
}

TEST(RecordDamage, FlippedBytesNeverCrash) {
    const TemporaryFolder folder;
    const SourceInfo info = make_info(PixelFormat::bgr24, 9, 7);
    write_recording(folder.file("whole.mkv"), info, 12);
    const std::vector<std::uint8_t> bytes = file_bytes(folder.file("whole.mkv"));
    std::uint32_t random = 1;
    for (int round = 0; round < 300; ++round) {
        std::vector<std::uint8_t> damaged = bytes;
        for (int i = 0; i < 3; ++i) {
            random = random * 1664525 + 1013904223;
            damaged[(random >> 8) % damaged.size()] ^= static_cast<std::uint8_t>(1U << (random >> 29));
        }
        put_file(folder.file("damaged.mkv"), damaged.data(), damaged.size());
        try {
            const Replay played = replay(folder.file("damaged.mkv"));
            EXPECT_EQ(std::count(played.error.begin(), played.error.end(), '\n'), 0) << played.error;
        } catch (const std::invalid_argument& error) {
            EXPECT_THAT(error.what(), HasSubstr("damaged.mkv"));
        }
    }
}

TEST(RecordDamage, AKilledWriterLeavesAReadableFile) {
    const TemporaryFolder folder;
    const std::string path = folder.file("killed.mkv");
    const SourceInfo info = make_info(PixelFormat::yuyv, 32, 24);
    constexpr int count = 100;  // of 30 per second
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        RecordingWriter writer(path, info);
        for (int i = 0; i < count; ++i) {
            writer.write(make_frame(info, i).frame);
        }
        kill(getpid(), SIGKILL);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status));

    const Replay played = replay(path);
    EXPECT_THAT(played.error,
                AllOf(StartsWith(path + ": truncated: "), HasSubstr("the recorder was stopped before it closed")));
    EXPECT_GE(played.frames.size(), std::size_t{count - 17});  // half a second
    expect_beginning(played.frames, info);
    EXPECT_FALSE(played.info.frame_count.has_value());
}

TEST(RecordDamage, AFullDiskLeavesAValidFile) {
    const TemporaryFolder folder;
    const std::string path = folder.file("full.mkv");
    const SourceInfo info = make_info(PixelFormat::grey8, 64, 48);
    std::string error;
    std::uint64_t kept = 0;
    {
        const FileSizeLimit limit(100'000);
        RecordingWriter writer(path, info);
        for (int i = 0; i < 1000 && error.empty(); ++i) {
            try {
                writer.write(make_frame(info, i).frame);
            } catch (const std::runtime_error& problem) {
                error = problem.what();
            }
        }
        EXPECT_THROW(writer.write(make_frame(info, 0).frame), std::runtime_error);
        EXPECT_NO_THROW(writer.close());
        kept = writer.frames();
        EXPECT_EQ(writer.bytes(), file_bytes(path).size());
    }
    EXPECT_THAT(error, AllOf(StartsWith(path + ": cannot write: File too large"),
                             HasSubstr("keeps the first " + std::to_string(kept) + " frames")));
    EXPECT_GT(kept, 10U);
    const Replay played = replay(path);
    EXPECT_EQ(played.error, "");
    EXPECT_EQ(played.frames.size(), kept);
    EXPECT_EQ(played.info.frame_count, kept);
    expect_beginning(played.frames, info);
    EXPECT_GT(file_bytes(path).size() + 2 * 64 * 48 * 3 / 2, 100'000U) << "one more frame would fit";
}

/// Writes frames until the writer refuses, at most 200; returns what it says.
std::string write_until_refused(RecordingWriter& writer, const SourceInfo& info, int first) {
    try {
        for (int i = first; i < 200; ++i) {
            writer.write(make_frame(info, i).frame);
        }
        writer.close();
    } catch (const std::runtime_error& error) {
        return error.what();
    }
    return "";
}

void write_frames(RecordingWriter& writer, const SourceInfo& info, int count) {
    for (int i = 0; i < count; ++i) {
        writer.write(make_frame(info, i).frame);
    }
}

TEST(RecordDamage, AFileThatIsRemovedWhileItIsWrittenIsNotComplete) {
    const TemporaryFolder folder;
    const SourceInfo info = make_info(PixelFormat::yuyv, 32, 24);
    const std::string folder_of_one = folder.file("gone");
    std::filesystem::create_directory(folder_of_one);
    for (const std::string& path : {folder.file("r.mkv"), folder_of_one + "/r.mkv"}) {
        SCOPED_TRACE(path);
        RecordingWriter writer(path, info);
        write_frames(writer, info, 40);
        path.starts_with(folder_of_one) ? std::filesystem::remove_all(folder_of_one) : std::filesystem::remove(path);
        EXPECT_EQ(write_until_refused(writer, info, 40),
                  path + ": cannot write: the file was removed while it was written, or its folder was");
        EXPECT_EQ(writer.frames(), 0U);
    }
    // Between the last frame and the end, too.
    RecordingWriter writer(folder.file("r.mkv"), info);
    write_frames(writer, info, 3);
    std::filesystem::remove(folder.file("r.mkv"));
    EXPECT_THAT([&] { writer.close(); }, ::testing::ThrowsMessage<std::runtime_error>(HasSubstr("was removed")));
}

TEST(RecordDamage, AFileThatIsCutWhileItIsWrittenKeepsWhatIsWhole) {
    const TemporaryFolder folder;
    const std::string path = folder.file("r.mkv");
    const SourceInfo info = make_info(PixelFormat::yuyv, 32, 24);
    for (const double part : {0.0, 0.4, 0.9}) {
        SCOPED_TRACE(part);
        RecordingWriter writer(path, info, true);
        write_frames(writer, info, 60);
        std::filesystem::resize_file(path, static_cast<std::uintmax_t>(part * static_cast<double>(writer.bytes())));
        const std::string error = write_until_refused(writer, info, 60);
        EXPECT_THAT(error, StartsWith(path + ": cannot write: another program has cut the file while it was written"));
        if (writer.frames() == 0) {
            EXPECT_EQ(part, 0.0);
            continue;
        }
        EXPECT_THAT(error, ::testing::EndsWith("keeps the first " + std::to_string(writer.frames()) + " frames"));
        EXPECT_LT(writer.frames(), 60U);
        const Replay played = replay(path);
        EXPECT_EQ(played.error, "");
        EXPECT_EQ(played.frames.size(), writer.frames());
        expect_beginning(played.frames, info);
    }
}

TEST(RecordDamage, ADiskThatIsFullAtTheEndIsReportedByClose) {
    const TemporaryFolder folder;
    const std::string path = folder.file("full.mkv");
    const SourceInfo info = make_info(PixelFormat::grey8, 64, 48);
    RecordingWriter writer(path, info);
    for (int i = 0; i < 20; ++i) {
        writer.write(make_frame(info, i).frame);
    }
    {
        const FileSizeLimit limit(writer.bytes());
        EXPECT_THAT([&] { writer.close(); }, ::testing::ThrowsMessage<std::runtime_error>(HasSubstr("File too large")));
        EXPECT_NO_THROW(writer.close());
    }
    const Replay played = replay(path);
    EXPECT_EQ(played.error, "");
    EXPECT_EQ(played.frames.size(), writer.frames());
    EXPECT_GT(played.frames.size(), 10U);
    EXPECT_LT(played.frames.size(), 20U);
}

TEST(RecordDamage, AFullDeviceIsReportedAtTheStart) {
    if (!std::filesystem::exists("/dev/full")) {
        GTEST_SKIP() << "/dev/full is not there";
    }
    EXPECT_THAT([] { RecordingWriter("/dev/full", make_info(PixelFormat::grey8, 8, 8), true); },
                ::testing::ThrowsMessage<std::runtime_error>(HasSubstr("/dev/full: cannot write: No space left")));
}

TEST(RecordDamage, ARecorderStopsAndCountsWhenTheDiskIsFull) {
    const TemporaryFolder folder;
    const std::string path = folder.file("full.mkv");
    const SourceInfo info = make_info(PixelFormat::grey8, 64, 48);
    // Until the disk is full: on a busy machine most of what is offered at once is lost before it is written.
    constexpr std::uint64_t most = 1'000'000;
    std::uint64_t count = 0;
    Recorder::Status status;
    {
        const FileSizeLimit limit(100'000);
        Recorder recorder(path, info, 4);
        while (count < most && recorder.status().error.empty()) {
            recorder.offer(make_frame(info, static_cast<int>(count)).frame);
            ++count;
            std::this_thread::yield();
        }
        status = recorder.finish();
    }
    EXPECT_THAT(status.error, HasSubstr("File too large"));
    EXPECT_EQ(status.frames + status.dropped, count);
    const Replay played = replay(path);
    EXPECT_EQ(played.error, "");
    EXPECT_EQ(played.frames.size(), status.frames);
}

TEST(MatroskaSegment, IsFoundAndMeasured) {
    const std::vector<std::uint8_t> known{0x1A, 0x45, 0xDF, 0xA3, 0x82, 1, 2, 0x18, 0x53, 0x80, 0x67, 0x40, 0x10};
    const auto segment = find_segment(known);
    ASSERT_TRUE(segment.has_value());
    EXPECT_EQ(segment->size_offset, 11U);
    EXPECT_EQ(segment->size_length, 2);
    EXPECT_EQ(segment->data_offset, 13U);
    EXPECT_EQ(segment->size, 16U);
    for (std::size_t size = 0; size < known.size(); ++size) {
        EXPECT_FALSE(find_segment({known.data(), size}).has_value()) << size;
    }
    const std::vector<std::uint8_t> unknown{0x1A, 0x45, 0xDF, 0xA3, 0x80, 0x18, 0x53, 0x80, 0x67, 0xFF};
    ASSERT_TRUE(find_segment(unknown).has_value());
    EXPECT_FALSE(find_segment(unknown)->size.has_value());
}

}  // namespace
}  // namespace disparityd::capture::test
