// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <fstream>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "capture/frame_source.h"
#include "tests/tools/made_input.h"
#include "tests/tools/run_program.h"

namespace disparityd::test {
namespace {

using testing::HasSubstr;

/// What survives a recording: every frame's facts and pixels.
std::vector<std::string> frames_of(const std::string& uri) {
    capture::SourceOptions options;
    options.uri = uri;
    options.pace = capture::Pace::fastest;
    const auto source = capture::open_source(options);
    std::vector<std::string> frames;
    capture::RawFrame frame;
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    while (source->next(frame, deadline) == capture::FrameSource::Next::frame) {
        std::string text = std::to_string(frame.sequence) + ' ' + std::to_string(frame.monotonic_ns) + ' ' +
                           std::to_string(frame.realtime_ns) + ' ' + std::to_string(frame.flags) + ' ';
        for (int y = 0; y < frame.image.height; ++y) {
            text.append(reinterpret_cast<const char*>(frame.image.data + y * frame.image.stride),
                        static_cast<std::size_t>(2 * frame.image.eye_width * bytes_per_pixel(frame.image.format)));
        }
        frames.push_back(std::move(text));
        source->give_back(frame);
    }
    return frames;
}

using RecordTest = FolderTest;

TEST_F(RecordTest, ARecordingRecordedAgainIsTheSame) {
    make_recording(path("in.mkv"), 8, 64, 32);
    const Outcome outcome = run(DISPARITYCTL, {"record", path("out.mkv"), "--source", path("in.mkv"), "--json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto summary = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(summary["frames"], 8);
    EXPECT_EQ(summary["dropped"], 0);
    EXPECT_EQ(summary["bytes"], std::filesystem::file_size(path("out.mkv")));
    EXPECT_EQ(frames_of(path("in.mkv")), frames_of(path("out.mkv")));
}

TEST_F(RecordTest, AnOffsetOfTheTimesIsAddedOnce) {
    make_recording(path("in.mkv"), 2, 64, 32);
    const auto with = [&](std::vector<std::string> command, const std::string& offset) {
        command.insert(command.end(), {"--time-offset-us", offset});
        return run(DISPARITYCTL, command);
    };
    ASSERT_EQ(with({"record", path("out.mkv"), "--source", path("in.mkv")}, "-250").exit_code, 0);
    capture::SourceOptions options;
    options.uri = path("out.mkv");
    const auto source = capture::open_source(options);
    EXPECT_EQ(source->info().time_offset_us, -250);
    EXPECT_THAT(frames_of(path("out.mkv")).at(0), testing::StartsWith("0 999750000 1700000000999750000 "));
    ASSERT_EQ(with({"process", path("in.mkv"), "-o", path("a"), "--disparities", "16"}, "300").exit_code, 0);
    EXPECT_THAT(read_file(path("a/times.csv")), HasSubstr(",1000300000,"));
    EXPECT_EQ(with({"process", path("out.mkv"), "-o", path("b"), "--disparities", "16"}, "-250").exit_code, 0);
    EXPECT_THAT(read_file(path("b/times.csv")), HasSubstr(",999750000,"));
    const Outcome again = with({"process", path("out.mkv"), "-o", path("c")}, "300");
    EXPECT_EQ(again.exit_code, 2);
    EXPECT_THAT(again.err, HasSubstr("found 300, but the stamps of " + path("out.mkv") + " contain -250 us"));
    EXPECT_THAT(with({"record", "x.mkv"}, "5").err, HasSubstr("--time-offset-us and --force go with --source"));
}

TEST_F(RecordTest, FoldersAreRecordedWithoutLoss) {
    make_kitti_folder(path("in"), 5, 65, 31);
    const Outcome outcome = run(DISPARITYCTL, {"record", path("out.mkv"), "--source", path("in"), "--frames", "4"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    auto expected = frames_of(path("in"));
    expected.resize(4);
    EXPECT_EQ(frames_of(path("out.mkv")), expected);
}

TEST_F(RecordTest, AnExistingFileIsKept) {
    make_recording(path("in.mkv"), 2, 64, 32);
    write_text(path("out.mkv"), "precious");
    const Outcome refused = run(DISPARITYCTL, {"record", path("out.mkv"), "--source", path("in.mkv")});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err, HasSubstr("out.mkv"));
    EXPECT_EQ(read_file(path("out.mkv")), "precious");
    EXPECT_EQ(run(DISPARITYCTL, {"record", path("out.mkv"), "--source", path("in.mkv"), "--force"}).exit_code, 0);
    std::filesystem::create_symlink(path("in.mkv"), path("link.mkv"));
    const Outcome itself = run(DISPARITYCTL, {"record", path("link.mkv"), "--source", path("in.mkv"), "--force"});
    EXPECT_EQ(itself.exit_code, 2);
    EXPECT_THAT(itself.err, HasSubstr("the source itself"));
    EXPECT_FALSE(frames_of(path("in.mkv")).empty());
    EXPECT_EQ(frames_of(path("out.mkv")).size(), 2U);
}

TEST_F(RecordTest, OneProcessAtATimeWritesAFile) {
    make_recording(path("in.mkv"), 2, 64, 32);
    Program first(DISPARITYCTL,
                  {"record", path("out.mkv"), "--source", "scene:vga@30?width=128&height=96&loop=8", "--json"});
    ASSERT_TRUE(eventually([&] {
        return !first.running() ||
               (std::filesystem::exists(path("out.mkv")) && std::filesystem::file_size(path("out.mkv")) > 100'000);
    }));
    first.send(SIGSTOP);
    const Outcome second = run(DISPARITYCTL, {"record", path("out.mkv"), "--source", path("in.mkv"), "--force"});
    first.send(SIGCONT);
    first.send(SIGINT);
    EXPECT_EQ(second.exit_code, 1) << second.err;
    EXPECT_THAT(second.err, testing::AllOf(HasSubstr("out.mkv"), HasSubstr("another program is writing it")));
    const Outcome outcome = first.wait();
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(frames_of(path("out.mkv")).size(), nlohmann::json::parse(outcome.out)["frames"]);
    EXPECT_EQ(run(DISPARITYCTL, {"record", path("out.mkv"), "--source", path("in.mkv"), "--force"}).exit_code, 0);
    EXPECT_EQ(frames_of(path("out.mkv")).size(), 2U) << "the lock ends with the process";
}

TEST_F(RecordTest, CtrlCLeavesAValidFile) {
    Program program(DISPARITYCTL,
                    {"record", path("out.mkv"), "--source", "scene:vga@30?width=128&height=96&loop=8", "--json"});
    ASSERT_TRUE(eventually([&] {
        return !program.running() ||
               (std::filesystem::exists(path("out.mkv")) && std::filesystem::file_size(path("out.mkv")) > 100'000);
    }));
    program.send(SIGINT);
    const Outcome outcome = program.wait();
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto summary = nlohmann::json::parse(outcome.out);
    EXPECT_GT(summary["frames"], 1);
    EXPECT_EQ(frames_of(path("out.mkv")).size(), summary["frames"]);
}

TEST_F(RecordTest, ADiskThatIsTooSlowIsSaidAtOnceAndTheFileIsValid) {
    // A disk that takes nothing for a while: a pipe.
    ASSERT_EQ(mkfifo(path("pipe.mkv").c_str(), 0600), 0);
    const int disk = open(path("pipe.mkv").c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    ASSERT_GE(disk, 0);
    Program program(DISPARITYCTL, {"record", path("pipe.mkv"), "--source", "scene:vga@60", "--force", "--json"});
    EXPECT_TRUE(eventually([&] { return !program.running() || program.said("frames come faster"); }));
    program.send(SIGINT);
    fcntl(disk, F_SETFL, 0);  // from here on, reading waits
    std::ofstream copy(path("copy.mkv"), std::ios::binary);
    std::vector<char> part(65536);
    for (ssize_t got = 0; (got = read(disk, part.data(), part.size())) > 0;) {
        copy.write(part.data(), got);
    }
    close(disk);
    copy.close();
    const Outcome outcome = program.wait();
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.err,
                HasSubstr("pipe.mkv: frames come faster than they can be written and are dropped: record to"));
    const auto summary = nlohmann::json::parse(outcome.out);
    EXPECT_GT(summary["dropped"], 0);
    // A pipe does not let the writer put the number of frames at the beginning: the source says so at its end.
    capture::SourceOptions options;
    options.uri = path("copy.mkv");
    options.pace = capture::Pace::fastest;
    const auto source = capture::open_source(options);
    std::uint64_t frames = 0;
    const auto play = [&] {
        capture::RawFrame frame;
        const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(1);
        for (; source->next(frame, deadline) == capture::FrameSource::Next::frame; ++frames) {
            source->give_back(frame);
        }
    };
    EXPECT_THAT(play, testing::ThrowsMessage<std::runtime_error>(HasSubstr("stopped before it closed")));
    EXPECT_EQ(frames, summary["frames"]);
}

/// No file of the programs that are started meanwhile may grow beyond that.
class FileSizeOfChildren {
public:
    explicit FileSizeOfChildren(rlim_t bytes) {
        getrlimit(RLIMIT_FSIZE, &before_);
        rlimit limit = before_;
        limit.rlim_cur = bytes;
        EXPECT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
    }
    ~FileSizeOfChildren() { setrlimit(RLIMIT_FSIZE, &before_); }
    FileSizeOfChildren(const FileSizeOfChildren&) = delete;
    FileSizeOfChildren& operator=(const FileSizeOfChildren&) = delete;

private:
    rlimit before_{};
};

TEST_F(RecordTest, ALimitOfFilesIsAFullDisk) {
    make_recording(path("in.mkv"), 100, 128, 64);
    const FileSizeOfChildren limit(1'000'000);
    const Outcome outcome = run(DISPARITYCTL, {"record", path("out.mkv"), "--source", path("in.mkv")});
    EXPECT_EQ(outcome.exit_code, 1) << "128 + 25 is SIGXFSZ";
    EXPECT_THAT(outcome.err, HasSubstr("out.mkv"));
    EXPECT_THAT(outcome.err, HasSubstr("File too large"));
    EXPECT_FALSE(frames_of(path("out.mkv")).empty()) << "what was written is a recording";
}

TEST_F(RecordTest, ALimitOfFilesEndsProcessWithALine) {
    make_recording(path("in.mkv"), 2, 320, 200);
    const FileSizeOfChildren limit(20'000);
    const Outcome outcome =
        run(DISPARITYCTL, {"process", path("in.mkv"), "--output", path("out"), "--disparities", "32"});
    EXPECT_EQ(outcome.exit_code, 1) << "128 + 25 is SIGXFSZ";
    EXPECT_THAT(outcome.err, HasSubstr("disparityctl: error: "));
    EXPECT_THAT(outcome.err, HasSubstr(path("out")));
}

TEST_F(RecordTest, WithoutAFrameNoFileIsMadeAndNoneReplaced) {
    make_recording(path("in.mkv"), 3, 128, 64);
    const std::string bytes = read_file(path("in.mkv"));
    const auto cluster = bytes.find("\x1f\x43\xb6\x75");  // of Matroska: frames follow
    ASSERT_NE(cluster, std::string::npos);
    write_text(path("in.mkv"), bytes.substr(0, cluster + 200));  // a part of the first frame
    write_text(path("old.mkv"), "what was there before");
    const Outcome outcome = run(DISPARITYCTL, {"record", path("new.mkv"), "--source", path("in.mkv")});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err, HasSubstr("nothing was recorded"));
    EXPECT_EQ(outcome.out, "");
    EXPECT_FALSE(std::filesystem::exists(path("new.mkv")));
    EXPECT_EQ(run(DISPARITYCTL, {"record", path("old.mkv"), "--force", "--source", path("in.mkv")}).exit_code, 1);
    EXPECT_EQ(read_file(path("old.mkv")), "what was there before");
}

TEST_F(RecordTest, TruncatedSourceKeepsWhatIsThere) {
    make_recording(path("in.mkv"), 30, 128, 64);
    std::filesystem::resize_file(path("in.mkv"), std::filesystem::file_size(path("in.mkv")) / 2);
    const Outcome outcome = run(DISPARITYCTL, {"record", path("out.mkv"), "--source", path("in.mkv"), "--json"});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err, HasSubstr("in.mkv"));
    const auto summary = nlohmann::json::parse(outcome.out);
    EXPECT_NE(summary["error"], "");
    EXPECT_GT(summary["frames"], 5);
    EXPECT_EQ(frames_of(path("out.mkv")).size(), summary["frames"]);
}

using SourcesTest = FolderTest;

TEST_F(SourcesTest, KindsAreListed) {
    const Outcome outcome = run(DISPARITYCTL, {"sources", "--json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto kinds = nlohmann::json::parse(outcome.out);
    EXPECT_GE(kinds.size(), 3U);
    for (const auto& kind : kinds) {
        EXPECT_FALSE(kind["name"].get<std::string>().empty());
        EXPECT_THAT(run(DISPARITYCTL, {"sources"}).out, HasSubstr(kind["description"].get<std::string>()));
    }
}

TEST_F(SourcesTest, WhatARecordingSaysOfItselfIsOneLineWithoutControls) {
    make_kitti_folder(path("in\x1b[2J\nforged"), 1, 64, 32);
    ASSERT_EQ(run(DISPARITYCTL, {"record", path("out.mkv"), "--source", path("in\x1b[2J\nforged")}).exit_code, 0);
    const Outcome outcome = run(DISPARITYCTL, {"sources", path("out.mkv")});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("in?[2J?forged"));
    EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 2) << outcome.out;
    EXPECT_EQ(outcome.out.find('\x1b'), std::string::npos);
}

TEST_F(SourcesTest, AnOpenedSourceIsDescribed) {
    make_recording(path("in.mkv"), 7, 64, 32);
    const Outcome outcome = run(DISPARITYCTL, {"sources", path("in.mkv"), "--json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto source = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(source["eye_width"], 64);
    EXPECT_EQ(source["height"], 32);
    EXPECT_EQ(source["frames"], 7);
    EXPECT_EQ(source["frames_per_second"], 15);
    EXPECT_TRUE(source["calibration"].is_null());
    EXPECT_THAT(run(DISPARITYCTL, {"sources", path("in.mkv")}).out, HasSubstr("64 x 32"));
    EXPECT_EQ(run(DISPARITYCTL, {"sources", path("none.mkv")}).exit_code, 2);
}

}  // namespace
}  // namespace disparityd::test
