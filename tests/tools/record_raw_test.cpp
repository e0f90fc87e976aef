// SPDX-License-Identifier: Apache-2.0
//
// The raw pair of a daemon as messages of ROS 2. read_export.cjs reads such a file by another implementation.
#include <algorithm>
#include <map>
#include <set>

#include <gmock/gmock.h>

#include "calibration/calibration_correction.h"
#include "calibration/rectified_camera.h"
#include "capture/recording/recording_writer.h"
#include "tests/capture/played_source.h"
#include "tests/tools/daemon_on_scene.h"
#include "tests/tools/read_mcap.h"

namespace disparityd::test {
namespace {

using calibration::CalibrationCorrection;
using capture::test::play_all;
using capture::test::Played;
using testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

Played played(const std::string& uri) {
    capture::SourceOptions options;
    options.uri = uri;
    return play_all(options);
}

/// Both eyes of a frame, grey: the first of each two bytes.
Bytes luma_of(const Bytes& yuyv) {
    Bytes luma(yuyv.size() / 2);
    for (std::size_t i = 0; i < luma.size(); ++i) {
        luma[i] = yuyv[2 * i];
    }
    return luma;
}

std::int64_t stamp_of(const formats::RosMessage& fields) {
    return fields.integer("header.stamp.sec") * 1'000'000'000 + fields.integer("header.stamp.nanosec");
}

/// The bytes of a field of all messages of a topic, by their stamps.
std::map<std::int64_t, Bytes> bytes_in(const std::string& path, const std::string& topic, const std::string& field) {
    std::map<std::int64_t, Bytes> all;
    read_mcap(path, [&](const McapRead& read) {
        if (read.topic == topic) {
            const auto bytes = read.fields.bytes(field);
            all[stamp_of(read.fields)].assign(bytes.begin(), bytes.end());
        }
    });
    return all;
}

std::map<std::int64_t, std::vector<double>> numbers_in(const std::string& path, const std::string& topic,
                                                       const std::string& field) {
    std::map<std::int64_t, std::vector<double>> all;
    read_mcap(path, [&](const McapRead& read) {
        if (read.topic == topic) {
            all[stamp_of(read.fields)] = read.fields.numbers(field);
        }
    });
    return all;
}

class RawOfDaemonTest : public DaemonTest {
protected:
    std::vector<std::string> settings() const override {
        return {"rectify.raw=true", "self_calibration.enabled=false"};
    }

    /// Records and returns the summary.
    nlohmann::json record(const std::string& file, const std::string& contents, const std::string& frames) const {
        const Outcome outcome =
            ctl("record", {"--mcap", path(file), "--force", "--frames", frames, "--contents", contents, "--json"});
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        return nlohmann::json::parse(outcome.out);
    }
};

TEST_F(RawOfDaemonTest, ReadBackItGivesWhatTheDaemonGave) {
    const nlohmann::json summary = record("a.mcap", "raw,disparity,tf", "6");
    const auto frames = summary["frames"].get<std::size_t>();
    EXPECT_GE(frames, 6U);
    EXPECT_EQ(summary["without_camera_info"], 0);
    EXPECT_TRUE(summary["dropped_before"].is_number());
    for (const char* topic :
         {"left/image_raw", "left/camera_info", "right/image_raw", "right/camera_info", "disparity"}) {
        EXPECT_EQ(summary["topics"][std::string("/stereo/") + topic], frames) << topic;
    }

    const Played drawn = played(source() + "&frames=8");
    std::vector<Bytes> pairs;
    std::transform(drawn.frames.begin(), drawn.frames.end(), std::back_inserter(pairs), luma_of);
    const Played read = played(path("a.mcap"));
    EXPECT_EQ(read.problem, "");
    ASSERT_EQ(read.frames.size(), frames);
    EXPECT_TRUE(std::all_of(read.frames.begin(), read.frames.end(), [&pairs](const Bytes& pair) {
        return std::find(pairs.begin(), pairs.end(), pair) != pairs.end();
    }));
    ASSERT_TRUE(read.info.calibration);
    EXPECT_EQ(read.info.calibration->left.fx, drawn.info.calibration->left.fx);
    EXPECT_EQ(read.info.calibration->right.distortion, drawn.info.calibration->right.distortion);
    EXPECT_NEAR(read.info.calibration->translation[0], drawn.info.calibration->translation[0], 1e-9);

    const Outcome matched = run(DISPARITYCTL, {"export", path("a.mcap"), "--mcap", path("b.mcap"), "--disparities",
                                               "16", "--contents", "raw,disparity,tf"});
    ASSERT_EQ(matched.exit_code, 0) << matched.err;
    EXPECT_TRUE(bytes_in(path("a.mcap"), "/stereo/left/image_raw", "data") ==
                bytes_in(path("b.mcap"), "/stereo/left/image_raw", "data"));
    const auto disparities = bytes_in(path("a.mcap"), "/stereo/disparity", "image.data");
    EXPECT_EQ(disparities.size(), frames);
    EXPECT_TRUE(disparities == bytes_in(path("b.mcap"), "/stereo/disparity", "image.data"));
}

/// A recording whose calibration is corrected in its second half, played again and again.
class CorrectedDaemonTest : public RawOfDaemonTest {
protected:
    static constexpr int half = 8;
    static constexpr std::int64_t period_ns = 100'000'000;
    static constexpr CalibrationCorrection turned{4'000'000, 0, -3'000'000, 0};

    void SetUp() override {
        const std::string folder = testing::TempDir() + "corrected-" + std::to_string(getpid());
        std::filesystem::create_directory(folder);
        file_ = folder + "/r.mkv";
        capture::SourceOptions options;
        options.uri = "scene:vga@10?width=128&height=96&frames=" + std::to_string(2 * half);
        options.pace = capture::Pace::fastest;
        const auto source = capture::open_source(options);
        calibration_ = source->info().calibration.value();
        capture::RecordingWriter writer(file_, source->info(), true);
        capture::RawFrame frame;
        for (int i = 0; source->next(frame, capture::test::soon()) == capture::FrameSource::Next::frame; ++i) {
            frame.correction = i < half ? CalibrationCorrection{} : turned;
            frame.monotonic_ns = i * period_ns;
            frame.realtime_ns = 1'700'000'000'000'000'000 + i * period_ns;
            writer.write(frame);
            source->give_back(frame);
        }
        writer.close();
        RawOfDaemonTest::SetUp();
    }
    void TearDown() override {
        RawOfDaemonTest::TearDown();
        std::filesystem::remove_all(std::filesystem::path(file_).parent_path());
    }

    std::string source() const override { return file_; }
    std::vector<std::string> settings() const override { return {"rectify.raw=true", "source.loop=true"}; }

    /// How the left eye is turned to be rectified.
    std::vector<double> turn(const CalibrationCorrection& correction) const {
        const auto camera =
            rectified_camera(corrected(calibration_, correction), calibration_.width, calibration_.height);
        return {camera.turn[0].begin(), camera.turn[0].end()};
    }

    std::string file_;
    calibration::StereoCalibration calibration_;
};

TEST_F(CorrectedDaemonTest, EachPairHasTheLensesOfItsCalibration) {
    const Played recorded = played(file_);
    ASSERT_EQ(recorded.frames.size(), 2U * half);
    std::map<Bytes, int> index_of;  // by the left image
    for (int i = 0; i < 2 * half; ++i) {
        const Bytes pair = luma_of(recorded.frames[static_cast<std::size_t>(i)]);
        Bytes left;
        for (std::size_t y = 0; y < 96; ++y) {
            const auto row = pair.begin() + static_cast<std::ptrdiff_t>(y * 2 * 128);
            left.insert(left.end(), row, row + 128);
        }
        index_of[left] = i;
    }
    ASSERT_EQ(index_of.size(), 2U * half) << "each frame is known by its image";
    const std::vector<double> turns[] = {turn({}), turn(turned)};
    ASSERT_NE(turns[0], turns[1]);

    // A daemon that takes long to answer tells of a calibration after its frames: then they have no camera_info.
    std::set<bool> seen;
    EXPECT_TRUE(eventually([&] {
        const nlohmann::json summary = record("a.mcap", "raw", std::to_string(3 * half));
        const auto images = bytes_in(path("a.mcap"), "/stereo/left/image_raw", "data");
        const auto told = numbers_in(path("a.mcap"), "/stereo/left/camera_info", "r");
        EXPECT_EQ(summary["topics"]["/stereo/left/image_raw"], summary["topics"]["/stereo/right/image_raw"]);
        EXPECT_EQ(summary["frames"].get<int>() - summary["without_camera_info"].get<int>(),
                  summary["topics"]["/stereo/left/camera_info"]);
        for (const auto& [stamp, r] : told) {
            const auto image = images.find(stamp);
            const auto index = image == images.end() ? index_of.end() : index_of.find(image->second);
            EXPECT_NE(index, index_of.end());
            const bool second = index != index_of.end() && index->second >= half;
            EXPECT_THAT(r, testing::Pointwise(testing::DoubleNear(1e-12), turns[second ? 1 : 0]));
            seen.insert(second);
        }
        return HasFailure() || seen.size() == 2;
    }));
}

/// A source without a calibration.
class UncalibratedDaemonTest : public RawOfDaemonTest {
protected:
    void SetUp() override {
        file_ = testing::TempDir() + "uncalibrated-" + std::to_string(getpid()) + ".mkv";
        make_recording(file_, 8, 64, 32);
        RawOfDaemonTest::SetUp();
    }
    void TearDown() override {
        RawOfDaemonTest::TearDown();
        std::filesystem::remove(file_);
    }
    std::string source() const override { return file_; }
    std::vector<std::string> settings() const override { return {"rectify.raw=true", "source.loop=true"}; }

    std::string file_;
};

TEST_F(UncalibratedDaemonTest, ThePairComesWithoutLenses) {
    const Outcome outcome = ctl("record", {"--mcap", path("a.mcap"), "--frames", "2", "--contents", "raw,tf"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("/stereo/left/camera_info is left out: the daemon has no calibration"));
    EXPECT_FALSE(bytes_in(path("a.mcap"), "/stereo/right/image_raw", "data").empty());
}

}  // namespace
}  // namespace disparityd::test
