// SPDX-License-Identifier: Apache-2.0
#include <sstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <sched.h>
#include <signal.h>
#include <unistd.h>

#include "capture/frame_source.h"
#include "tests/tools/daemon_on_scene.h"
#include "tools/images/disparity_file.h"
#include "tools/images/image_file.h"
#include "tools/images/picture.h"

namespace disparityd::test {
namespace {

using testing::HasSubstr;

TEST_F(DaemonTest, StatusTellsWhatRuns) {
    const nlohmann::json now = status();
    EXPECT_EQ(now["state"], "running");
    EXPECT_EQ(now["method"], "sgm");
    EXPECT_EQ(now["geometry"]["width"], 128);
    EXPECT_EQ(now["geometry"]["disparities"], 16);
    EXPECT_FALSE(now["steps"].empty());
    EXPECT_THAT(ctl("status", {}).out, HasSubstr("128 x 96"));
}

/// tests/tools/mcap_export_test.cpp looks into such files.
TEST_F(DaemonTest, RecordsWhatItIsSentAsMessages) {
    const Outcome outcome = ctl("record", {"--mcap", path("a.mcap"), "--frames", "3", "--contents",
                                           "rectified,disparity,depth,points,tf", "--json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto summary = nlohmann::json::parse(outcome.out);
    const int frames = summary["frames"];
    EXPECT_GE(frames, 3);
    EXPECT_TRUE(summary["dropped"].is_number());
    EXPECT_EQ(summary["topics"]["/tf_static"], 1);
    for (const char* topic :
         {"left/image_rect", "left/camera_info", "disparity", "depth/image_rect", "depth/camera_info", "points2"}) {
        EXPECT_EQ(summary["topics"][std::string("/stereo/") + topic], frames) << topic;
    }
    EXPECT_EQ(summary["bytes"], std::filesystem::file_size(path("a.mcap")));
    // The configuration does not serve the right image.
    EXPECT_THAT(outcome.err, HasSubstr("/stereo/right/image_rect is left out: the daemon does not serve"));

    Program record(DISPARITYCTL, arguments("record", {"--mcap", path("b.mcap"), "--contents", "disparity"}));
    ASSERT_TRUE(eventually([&] {
        return !record.running() ||
               (std::filesystem::exists(path("b.mcap")) && std::filesystem::file_size(path("b.mcap")) > 10'000);
    }));
    record.send(SIGINT);
    EXPECT_EQ(record.wait().exit_code, 0);
    EXPECT_TRUE(read_file(path("b.mcap")).ends_with("\x89MCAP0\r\n"));

    EXPECT_THAT(ctl("record", {"--mcap", path("c.mcap"), "--contents", "raw"}).err,
                HasSubstr("--contents raw: the daemon does not serve the product raw_left: set rectify.raw = true"));
    EXPECT_THAT(ctl("record", {"--mcap", path("c.mcap"), "--contents", "scan"}).err,
                HasSubstr("--contents scan: the daemon does not serve the product scan: set scan.enabled = true"));
    EXPECT_FALSE(std::filesystem::exists(path("c.mcap")));
}

TEST_F(DaemonTest, WatchCountsFramesOverBothWays) {
    for (const bool by_socket : {false, true}) {
        std::vector<std::string> more{"--count", "2", "--json"};
        if (by_socket) {
            more.insert(more.end(), {"--socket", "unix:" + socket_});
        }
        const Outcome outcome = ctl("watch", more);
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
        std::istringstream lines(outcome.out);
        int count = 0;
        std::uint64_t frames = 0;
        for (std::string line; std::getline(lines, line); ++count) {
            const auto seen = nlohmann::json::parse(line);
            frames += seen["frames"].get<std::uint64_t>();
            if (seen["frames"] > 0) {
                EXPECT_GT(seen["latency_p50_ms"], 0);
                EXPECT_LE(seen["latency_p50_ms"], seen["latency_p99_ms"]);
            }
        }
        EXPECT_EQ(count, 2);
        EXPECT_GT(frames, 0U);
    }
}

TEST_F(DaemonTest, CtrlCEndsWatchInGoodOrder) {
    Program watch(DISPARITYCTL, arguments("watch", {}));
    ASSERT_TRUE(eventually([&] { return !watch.running() || watch.said("shared memory"); }));
    watch.send(SIGINT);
    const Outcome outcome = watch.wait();
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_FALSE(outcome.out.empty());
}

TEST_F(DaemonTest, WatchSaysThatTheDaemonHasStopped) {
    Program watch(DISPARITYCTL, arguments("watch", {}));
    ASSERT_TRUE(eventually([&] { return watch.said("shared memory"); }));
    daemon_->send(SIGTERM);
    EXPECT_EQ(daemon_->wait().exit_code, 0);
    const Outcome outcome = watch.wait();
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err, HasSubstr("the daemon has stopped"));
}

TEST_F(DaemonTest, WatchSaysThatTheDaemonOfItsSocketHangs) {
    Program watch(DISPARITYCTL, {"watch", "--json", "--socket", "unix:" + socket_});
    ASSERT_TRUE(eventually([&] { return watch.said("latency_p50_ms"); }));
    daemon_->send(SIGSTOP);
    EXPECT_TRUE(eventually([&] { return watch.said("no answer to hello in time"); }));
    daemon_->send(SIGCONT);
    watch.send(SIGINT);
    EXPECT_EQ(watch.wait().exit_code, 0);
}

TEST_F(DaemonTest, SnapshotWritesPictures) {
    const Outcome outcome =
        ctl("snapshot", {"-o", path("now.png"), "--disparity", path("d.png"), "--depth", path("z.png")});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const cv::Mat picture = images::read_image(path("now.png"));
    EXPECT_GE(picture.rows, 96);
    EXPECT_GT(picture.cols, 2 * 128);
    EXPECT_EQ(images::read_disparity_png(path("d.png")).width, 128);
    EXPECT_EQ(images::read_image(path("z.png")).type(), CV_16UC1);
    EXPECT_EQ(ctl("snapshot", {"--disparity", path("d.pfm"), "--socket", "unix:" + socket_}).exit_code, 0);
    EXPECT_EQ(images::read_disparity_pfm(path("d.pfm")).height, 96);
    EXPECT_EQ(ctl("snapshot", {}).exit_code, 2) << "nothing to write";
    EXPECT_THAT(ctl("snapshot", {"-o", path("one.png"), "--depth", path("one.png")}).err,
                HasSubstr("one.png: named for two images"));
    EXPECT_THAT(ctl("snapshot", {"-o", path("nowhere/one.png")}).err, HasSubstr("nowhere is not there"));
    EXPECT_THAT(ctl("snapshot", {"--depth-error", path("e.png")}).err, HasSubstr("set match.depth_error = true"));
    EXPECT_THAT(ctl("snapshot", {"--depth-error", path("e.png"), "--socket", "unix:" + socket_}).err,
                HasSubstr("found DEPTH_ERROR, allowed: DISPARITY, CONFIDENCE"));
}

TEST_F(DaemonTest, SnapshotWritesTheValuesOfAnyImage) {
    const Outcome outcome = ctl("snapshot", {"--values", "confidence=" + path("c.png"), "--values",
                                             "left=" + path("l.png"), "--values", "disparity=" + path("d.pfm")});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(images::read_image(path("c.png")).type(), CV_8UC1);
    EXPECT_EQ(images::read_image(path("l.png")).cols, 128);
    EXPECT_EQ(images::read_disparity_pfm(path("d.pfm")).height, 96);
    EXPECT_THAT(ctl("snapshot", {"--values", "scan=" + path("s.png")}).err,
                HasSubstr("found 'scan', allowed: NAME=FILE with one of disparity, confidence"));
    EXPECT_THAT(ctl("snapshot", {"--values", "left"}).err, HasSubstr("found 'left', allowed: NAME=FILE"));
    EXPECT_THAT(ctl("snapshot", {"--values", "depth=" + path("a.png"), "--depth", path("b.png")}).err,
                HasSubstr("a second file for the same image"));
}

TEST_F(DaemonTest, SnapshotOfADaemonThatHangsIsRefused) {
    daemon_->send(SIGSTOP);
    Outcome outcome;
    EXPECT_TRUE(eventually([&] {
        outcome = ctl("snapshot", {"-o", path("old.png")});
        return outcome.exit_code != 0;
    }));
    daemon_->send(SIGCONT);
    EXPECT_THAT(outcome.err, HasSubstr("the daemon has stopped"));
}

TEST_F(DaemonTest, TheNameSaysTheFormat) {
    ASSERT_EQ(ctl("snapshot", {"-o", path("now.jpg"), "--colour-range", "frame"}).exit_code, 0);
    EXPECT_EQ(read_file(path("now.jpg")).substr(0, 3), "\xff\xd8\xff");
    for (const auto& [option, file] : {std::pair("-o", "now.bmp"), std::pair("--disparity", "d.jpg"),
                                       std::pair("--depth", "z.pfm"), std::pair("--depth-error", "e.pfm")}) {
        const Outcome refused = ctl("snapshot", {option, path(file)});
        EXPECT_EQ(refused.exit_code, 2);
        EXPECT_THAT(refused.err, testing::AllOf(HasSubstr(file), HasSubstr("allowed: .png")));
        EXPECT_FALSE(std::filesystem::exists(path(file)));
    }
}

TEST_F(DaemonTest, APictureOfASceneSaysThatItIsSynthetic) {
    ASSERT_EQ(ctl("snapshot", {"-o", path("now.png")}).exit_code, 0);
    cv::Mat expected = images::read_image(path("now.png")).clone();
    images::mark_synthetic(expected);
    EXPECT_EQ(cv::norm(expected, images::read_image(path("now.png")), cv::NORM_INF), 0) << "the mark is there already";
    EXPECT_TRUE(status()["synthetic"]);
}

TEST_F(DaemonTest, HintsNameTheDaemon) {
    Program record(DISPARITYCTL, arguments("record", {"on.mkv"}));
    ASSERT_TRUE(eventually([&] { return !record.running() || recorded_frames() > 0; }));
    EXPECT_THAT(ctl("record", {"another.mkv"}).err,
                HasSubstr("disparityctl record --stop --name " + name_ + " --socket unix:" + socket_));
    record.send(SIGINT);
    EXPECT_EQ(record.wait().exit_code, 0);
}

TEST_F(DaemonTest, SensorsOfASceneAreRefused) {
    const Outcome outcome = ctl("sensors", {});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err, testing::AllOf(HasSubstr("scene:vga@30"), HasSubstr("has no sensors")));
}

/// A daemon whose source ends after some frames.
class EndedDaemonTest : public DaemonTest {
protected:
    std::string source() const override { return "scene:vga@30?width=128&height=96&loop=8&frames=8"; }
    void SetUp() override {
        DaemonTest::SetUp();
        ASSERT_TRUE(eventually([this] { return status()["state"] == "ended"; }));
    }
};

TEST_F(EndedDaemonTest, StatusTellsNoRateFromBefore) {
    EXPECT_EQ(status()["rate"], 0);
}

TEST_F(EndedDaemonTest, WatchShowsNoFrameFromBefore) {
    for (const std::vector<std::string>& way : {std::vector<std::string>{}, {"--socket", "unix:" + socket_}}) {
        std::vector<std::string> more{"--count", "1", "--json"};
        more.insert(more.end(), way.begin(), way.end());
        const Outcome outcome = ctl("watch", more);
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
        const auto line = nlohmann::json::parse(outcome.out);
        EXPECT_EQ(line["frames"], 0);
        if (way.empty()) {  // the memory still has the last one
            EXPECT_THAT(line["why"].get<std::string>(), testing::ContainsRegex("; the newest frame is [0-9.]+ s old$"));
        } else {  // else the tool knows no socket to ask at
            EXPECT_THAT(line["why"].get<std::string>(),
                        testing::ContainsRegex("the source has ended after [1-8] frames?; reload to play it again"))
                << "a busy machine loses some of the eight";
        }
    }
}

TEST_F(EndedDaemonTest, SnapshotDoesNotTakeAnOldFrameForANewOne) {
    Outcome outcome;
    EXPECT_TRUE(eventually([&] {
        outcome = ctl("snapshot", {"-o", path("old.png"), "--timeout", "1"});
        return outcome.exit_code != 0;
    })) << "the frame grows older than a second";
    EXPECT_THAT(outcome.err, testing::ContainsRegex("no frame came within 1 s: .*; the newest frame is [0-9.]+ s old"));
}

/// Programs that are started meanwhile run on one core only.
class OneCore {
public:
    OneCore() {
        EXPECT_EQ(sched_getaffinity(0, sizeof before_, &before_), 0);
        cpu_set_t one;
        CPU_ZERO(&one);
        CPU_SET(static_cast<std::size_t>(sched_getcpu()), &one);
        EXPECT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
    }
    ~OneCore() { sched_setaffinity(0, sizeof before_, &before_); }
    OneCore(const OneCore&) = delete;
    OneCore& operator=(const OneCore&) = delete;

private:
    cpu_set_t before_{};
};

/// A daemon that renders for a long time before it has its first frame, however many cores the machine has.
class PreparingDaemonTest : public DaemonTest {
protected:
    void SetUp() override {
        const OneCore slow;
        DaemonTest::SetUp();
    }
    std::string source() const override { return "scene:hd1080@15?loop=24"; }
    void wait_for_frames() override {}
};

TEST_F(PreparingDaemonTest, SaysThatItPreparesItsSource) {
    const nlohmann::json now = status();
    ASSERT_EQ(now["state"], "waiting");
    EXPECT_EQ(now["detail"], "the daemon is preparing its source");
    EXPECT_EQ(now["source"], source());
    EXPECT_THAT(ctl("status", {}).out, testing::Not(HasSubstr("0 x 0")));
    const Outcome outcome = ctl("snapshot", {"-o", path("x.png"), "--timeout", "1", "--socket", "unix:" + socket_});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err, HasSubstr("no frame came within 1 s: the daemon is preparing its source"));
}

TEST_F(DaemonTest, RecordAsksTheDaemon) {
    const Outcome outcome = ctl("record", {"walk.mkv", "--frames", "5", "--json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto summary = nlohmann::json::parse(outcome.out);
    EXPECT_GE(summary["frames"], 5);
    EXPECT_EQ(summary["path"], path("recordings/walk.mkv"));
    capture::SourceOptions options;
    options.uri = path("recordings/walk.mkv");
    const auto recording = capture::open_source(options);
    EXPECT_EQ(recording->info().frame_count, summary["frames"].get<std::uint64_t>());
    EXPECT_TRUE(recording->info().calibration.has_value());

    const Outcome outside = ctl("record", {"/nowhere/walk.mkv", "--frames", "5"});
    EXPECT_EQ(outside.exit_code, 1);
    EXPECT_THAT(outside.err, HasSubstr("/nowhere/walk.mkv"));
}

TEST_F(DaemonTest, SignalsStopARecordingInGoodOrder) {
    for (const int signal : {SIGINT, SIGHUP, SIGTERM}) {
        const std::string file = "stop" + std::to_string(signal) + ".mkv";
        Program record(DISPARITYCTL, arguments("record", {file, "--json"}));
        ASSERT_TRUE(eventually([&] { return !record.running() || recorded_frames() > 3; }));
        record.send(signal);
        record.send(signal);  // timeout(1) sends one to the program and one to its group
        const Outcome outcome = record.wait();
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
        EXPECT_EQ(status()["record"]["active"], false);
        capture::SourceOptions options;
        options.uri = path("recordings/" + file);
        EXPECT_EQ(capture::open_source(options)->info().frame_count,
                  nlohmann::json::parse(outcome.out)["frames"].get<std::uint64_t>());
    }
}

// The daemon takes a while to answer: however many signals come, it has been told to stop before the client ends.
TEST_F(DaemonTest, MoreSignalsHastenAStopAndNeverSkipIt) {
    Program record(DISPARITYCTL, arguments("record", {"on.mkv"}));
    ASSERT_TRUE(eventually([&] { return !record.running() || recorded_frames() > 3; }));
    daemon_->send(SIGSTOP);
    EXPECT_TRUE(eventually([&] {
        record.send(SIGTERM);
        return !record.running();
    }));
    const Outcome outcome = record.wait();
    daemon_->send(SIGCONT);
    EXPECT_EQ(outcome.exit_code, 130);
    EXPECT_THAT(outcome.err, HasSubstr("the daemon was told to stop recording and has not answered yet"));
    EXPECT_THAT(outcome.err, HasSubstr("record --stop --name " + name_));
    EXPECT_TRUE(eventually([&] { return status()["record"]["active"] == false; }));
    capture::SourceOptions options;
    options.uri = path("recordings/on.mkv");
    EXPECT_GT(capture::open_source(options)->info().frame_count, 3U);
}

TEST_F(DaemonTest, ARecordingThatNobodyWaitsForCanBeStopped) {
    EXPECT_THAT(ctl("record", {"--stop"}).err, HasSubstr("nothing is being recorded"));
    Program killed(DISPARITYCTL, arguments("record", {"on.mkv"}));
    ASSERT_TRUE(eventually([&] { return !killed.running() || recorded_frames() > 3; }));
    killed.send(SIGKILL);
    killed.wait();
    EXPECT_EQ(status()["record"]["active"], true);
    EXPECT_THAT(ctl("record", {"another.mkv"}).err, HasSubstr("record --stop --name " + name_));
    const Outcome stopped = ctl("record", {"--stop", "--json"});
    ASSERT_EQ(stopped.exit_code, 0) << stopped.err;
    EXPECT_EQ(nlohmann::json::parse(stopped.out)["path"], path("recordings/on.mkv"));
    EXPECT_EQ(status()["record"]["active"], false);
    EXPECT_EQ(ctl("record", {"--stop", "more.mkv"}).exit_code, 2);
    EXPECT_EQ(ctl("record", {}).exit_code, 2) << "no file";
}

}  // namespace
}  // namespace disparityd::test
