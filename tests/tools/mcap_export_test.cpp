// SPDX-License-Identifier: Apache-2.0
//
// A source exported as messages of ROS 2 and read back. read_export.cjs reads such a file by another implementation.
#include <array>
#include <filesystem>
#include <map>
#include <set>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "capture/recording/recording_writer.h"
#include "tests/capture/played_source.h"
#include "tests/tools/made_input.h"
#include "tests/tools/read_mcap.h"
#include "tests/tools/run_program.h"

namespace disparityd::test {
namespace {

using capture::test::play_all;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

constexpr int frames = 4;
constexpr std::int64_t start_ns = 1'700'000'000'000'000'000;
constexpr std::int64_t period_ns = 1'100'000'000;  // so that each frame has a chunk of its own

calibration::InertialCalibration mounted_sensor() {
    calibration::InertialCalibration inertial;
    inertial.to_left_camera = calibration::Pose{{0, -1, 0, 0, 0, -1, 1, 0, 0}, {10, -20, 30}};
    return inertial;
}

/// The topics of a file, with the fields of the last message of each.
struct Topic {
    std::string type;
    int messages = 0;
    std::map<std::string, std::array<double, 4>> turns;  ///< of /tf_static, by the child: x, y, z, w
    std::map<std::string, std::string> texts;
    std::map<std::string, std::vector<double>> numbers;
    std::vector<std::uint8_t> data;  ///< of images
    std::set<std::int64_t> stamps;
};

std::map<std::string, Topic> topics_in(const std::string& path) {
    std::map<std::string, Topic> topics;
    read_mcap(path, [&topics](const McapRead& read) {
        const auto& [name, type, message, fields] = read;
        Topic& topic = topics[name];
        topic.type = type;
        EXPECT_EQ(message.sequence, static_cast<std::uint32_t>(topic.messages++));
        const std::string header = type == "tf2_msgs/msg/TFMessage" ? "transforms.0.header" : "header";
        const std::int64_t stamp =
            fields.integer(header + ".stamp.sec") * 1'000'000'000 + fields.integer(header + ".stamp.nanosec");
        EXPECT_EQ(message.log_ns, static_cast<std::uint64_t>(stamp)) << name;
        topic.stamps.insert(stamp);
        topic.texts["frame"] = fields.text(header + ".frame_id");
        for (const char* text : {"encoding", "distortion_model"}) {
            if (fields.has(text)) {
                topic.texts[text] = fields.text(text);
            }
        }
        for (const char* numbers : {"k", "d", "r", "p", "ranges"}) {
            if (fields.has(numbers)) {
                topic.numbers[numbers] = fields.numbers(numbers);
            }
        }
        for (int i = 0; fields.has("transforms." + std::to_string(i) + ".child_frame_id"); ++i) {
            const std::string at = "transforms." + std::to_string(i) + ".";
            const std::string turn = at + "transform.rotation.";
            topic.turns[std::string(fields.text(at + "child_frame_id"))] = {
                fields.number(turn + "x"), fields.number(turn + "y"), fields.number(turn + "z"),
                fields.number(turn + "w")};
        }
        if (fields.has("data")) {
            const auto data = fields.bytes("data");
            topic.data.assign(data.begin(), data.end());
        }
    });
    return topics;
}

class McapExportTest : public FolderTest {
protected:
    /// Rendered frames as a recording, with samples of an inertial sensor and where that stands. `change` is made to
    /// what the recording says of itself, `change_frame` to each frame.
    void record(const std::string& name, const std::function<void(capture::SourceInfo&)>& change = {},
                const std::function<void(int, capture::RawFrame&)>& change_frame = {}) {
        capture::SourceOptions options;
        options.uri = "scene:vga@30?width=128&height=96&loop=4";
        options.pace = capture::Pace::fastest;
        const auto source = capture::open_source(options);
        capture::SourceInfo info = source->info();
        info.calibration->inertial = mounted_sensor();
        if (change) {
            change(info);
        }
        capture::RecordingWriter writer(path(name), info);
        for (int i = 0; i < frames; ++i) {
            capture::RawFrame frame;
            ASSERT_EQ(source->next(frame, std::chrono::steady_clock::now() + std::chrono::minutes(1)),
                      capture::FrameSource::Next::frame);
            capture::SensorSample sample;
            sample.flags = capture::sensor_flag_inertial | capture::sensor_flag_environment;
            sample.angular_velocity = {0.5F, 0, 0};
            sample.acceleration = {0, 0, 9.75F};
            sample.celsius = 25;
            frame.realtime_ns = start_ns + i * period_ns;
            sample.realtime_ns = frame.realtime_ns - 1000;
            frame.sensors = {&sample, 1};
            if (change_frame) {
                change_frame(i, frame);
            }
            writer.write(frame);
            source->give_back(frame);
        }
        writer.close();
    }

    Outcome export_to(const std::string& file, const std::string& source, std::vector<std::string> more = {}) {
        more.insert(more.begin(), {"--disparities", "16"});
        return copy_to(file, source, std::move(more));
    }

    /// Without an option of matching.
    Outcome copy_to(const std::string& file, const std::string& source, std::vector<std::string> more) {
        more.insert(more.begin(), {"export", path(source), "--mcap", path(file)});
        return run(DISPARITYCTL, more);
    }

    /// The pictures that `process` makes.
    std::map<std::string, std::string> pictures(const std::string& source, const std::string& folder,
                                                std::vector<std::string> more = {}) {
        more.insert(more.begin(), {"process", path(source), "-o", path(folder), "--disparities", "16"});
        const Outcome outcome = run(DISPARITYCTL, more);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        std::map<std::string, std::string> pictures = files_in(path(folder));
        std::erase_if(pictures, [](const auto& file) { return !file.first.ends_with(".png"); });
        return pictures;
    }
};

TEST_F(McapExportTest, ReadBackItGivesTheSameDisparities) {
    record("r.mkv");
    const Outcome outcome = export_to("r.mcap", "r.mkv");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("4 frames"));
    const auto expected = pictures("r.mkv", "a");
    EXPECT_EQ(expected.size(), static_cast<std::size_t>(frames));
    EXPECT_TRUE(pictures("r.mcap", "b") == expected);

    capture::SourceOptions options;
    options.uri = path("r.mcap");
    const auto read = play_all(options);
    options.uri = path("r.mkv");
    const auto recorded = play_all(options);
    EXPECT_TRUE(read.frames == recorded.frames);
    EXPECT_EQ(read.times, recorded.times);
    EXPECT_EQ(read.problem, "");
    ASSERT_EQ(read.samples.size(), recorded.samples.size());
    EXPECT_EQ(read.samples.back().acceleration, recorded.samples.back().acceleration);
    ASSERT_TRUE(read.info.calibration && read.info.calibration->inertial.to_left_camera);
    const calibration::Pose expected_pose = *mounted_sensor().to_left_camera;
    for (std::size_t i = 0; i < 9; ++i) {
        EXPECT_NEAR(read.info.calibration->inertial.to_left_camera->rotation[i], expected_pose.rotation[i], 1e-9) << i;
    }
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(read.info.calibration->inertial.to_left_camera->translation[i], expected_pose.translation[i], 1e-6);
    }
}

TEST_F(McapExportTest, ARectifiedSourceStaysOne) {
    record("r.mkv", [](capture::SourceInfo& info) {
        calibration::StereoCalibration& calibration = *info.calibration;
        calibration.left = calibration.right = {100, 100, 60, 48, {}};
        calibration.right.cx = 63;  // which gives a disparity offset
        calibration.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1};
        calibration.translation = {-120, 0, 0};
        calibration.rectified = true;
    });
    ASSERT_EQ(export_to("r.mcap", "r.mkv", {"--contents", "raw,rectified,tf"}).exit_code, 0);
    EXPECT_TRUE(pictures("r.mcap", "b", {"--depth"}) == pictures("r.mkv", "a", {"--depth"}));
    EXPECT_THAT(topics_in(path("r.mcap")), AllOf(Contains(testing::Key("/stereo/left/image_rect_color")),
                                                 Not(Contains(testing::Key("/stereo/left/image_raw")))));
}

TEST_F(McapExportTest, TheSameSourceGivesTheSameBytes) {
    record("r.mkv");
    const std::vector<std::string> all{"--contents",
                                       "raw,rectified,disparity,depth,depth-mm,confidence,points,scan,imu,sensors,tf",
                                       "--scan-set", "camera_height_m=0.4"};
    ASSERT_EQ(export_to("a.mcap", "r.mkv", all).exit_code, 0);
    const Outcome again = export_to("b.mcap", "r.mkv", all);
    ASSERT_EQ(again.exit_code, 0) << again.err;
    EXPECT_TRUE(read_file(path("a.mcap")) == read_file(path("b.mcap")));

    const std::map<std::string, Topic> topics = topics_in(path("a.mcap"));
    const std::map<std::string, std::string> types{{"/stereo/left/image_raw", "sensor_msgs/msg/Image"},
                                                   {"/stereo/right/image_raw", "sensor_msgs/msg/Image"},
                                                   {"/stereo/left/camera_info", "sensor_msgs/msg/CameraInfo"},
                                                   {"/stereo/right/camera_info", "sensor_msgs/msg/CameraInfo"},
                                                   {"/stereo/depth/camera_info", "sensor_msgs/msg/CameraInfo"},
                                                   {"/stereo/left/image_rect_color", "sensor_msgs/msg/Image"},
                                                   {"/stereo/right/image_rect_color", "sensor_msgs/msg/Image"},
                                                   {"/stereo/disparity", "stereo_msgs/msg/DisparityImage"},
                                                   {"/stereo/depth/image_rect", "sensor_msgs/msg/Image"},
                                                   {"/stereo/depth/image_rect_raw", "sensor_msgs/msg/Image"},
                                                   {"/stereo/confidence", "sensor_msgs/msg/Image"},
                                                   {"/stereo/points2", "sensor_msgs/msg/PointCloud2"},
                                                   {"/stereo/scan", "sensor_msgs/msg/LaserScan"},
                                                   {"/stereo/imu/data_raw", "sensor_msgs/msg/Imu"},
                                                   {"/stereo/temperature/imu", "sensor_msgs/msg/Temperature"},
                                                   {"/stereo/temperature/camera", "sensor_msgs/msg/Temperature"},
                                                   {"/stereo/atm_press", "sensor_msgs/msg/FluidPressure"},
                                                   {"/stereo/humidity", "sensor_msgs/msg/RelativeHumidity"},
                                                   {"/tf_static", "tf2_msgs/msg/TFMessage"}};
    std::map<std::string, std::string> found;
    for (const auto& [name, topic] : topics) {
        found[name] = topic.type;
        EXPECT_EQ(topic.messages, name == "/tf_static" ? 1 : frames) << name;
        EXPECT_EQ(topic.stamps.size(), static_cast<std::size_t>(topic.messages)) << name;
    }
    EXPECT_EQ(found, types);

    // The raw pair tells of its lenses, the rest of the rectified camera.
    const Topic& raw = topics.at("/stereo/left/camera_info");
    EXPECT_EQ(raw.texts.at("frame"), "stereo_left_raw_optical_frame");
    EXPECT_EQ(topics.at("/stereo/right/image_raw").texts.at("frame"), "stereo_left_raw_optical_frame");
    EXPECT_NE(raw.numbers.at("d"), std::vector<double>(5));
    EXPECT_NE(raw.numbers.at("r"), topics.at("/stereo/depth/camera_info").numbers.at("r"));
    EXPECT_EQ(raw.numbers.at("p"), topics.at("/stereo/depth/camera_info").numbers.at("p"));
    EXPECT_LT(topics.at("/stereo/right/camera_info").numbers.at("p")[3], 0);
    EXPECT_EQ(topics.at("/stereo/disparity").texts.at("frame"), "stereo_left_optical_frame");

    // The depth is that of `process`.
    const auto pictures_of_depth = pictures("r.mkv", "out", {"--depth"});
    const cv::Mat depth = cv::imread(path("out/000003_depth.png"), cv::IMREAD_UNCHANGED);
    ASSERT_EQ(depth.type(), CV_16UC1);
    const std::vector<std::uint8_t> pixels(depth.data, depth.data + depth.total() * depth.elemSize());
    EXPECT_TRUE(topics.at("/stereo/depth/image_rect_raw").data == pixels);
    EXPECT_GT(cv::countNonZero(depth), 1000);
}

TEST_F(McapExportTest, AFileThatWasCutOffPlaysUpToThere) {
    record("r.mkv");
    ASSERT_EQ(export_to("r.mcap", "r.mkv").exit_code, 0);
    const std::string whole = read_file(path("r.mcap"));
    capture::SourceOptions options;
    options.uri = path("r.mcap");
    const auto all = play_all(options);
    options.uri = path("cut.mcap");
    std::set<std::size_t> seen;
    for (int part = 1; part < 40; ++part) {
        write_text(options.uri, whole.substr(0, whole.size() * static_cast<std::size_t>(part) / 40));
        const auto cut = play_all(options);
        if (cut.frames.empty()) {
            EXPECT_NE(cut.problem, "");  // not even the first pair is whole
            continue;
        }
        ASSERT_LE(cut.frames.size(), all.frames.size());
        EXPECT_TRUE(std::equal(cut.frames.begin(), cut.frames.end(), all.frames.begin()));
        EXPECT_TRUE(cut.info.calibration);
        seen.insert(cut.frames.size());
    }
    EXPECT_THAT(seen, testing::IsSupersetOf({1U, 2U, 3U}));
}

TEST_F(McapExportTest, WithoutACalibrationThereAreNoDistances) {
    make_recording(path("r.mkv"), 2, 64, 32);
    const Outcome usual = export_to("r.mcap", "r.mkv");
    EXPECT_EQ(usual.exit_code, 0) << usual.err;
    EXPECT_THAT(usual.err, HasSubstr("depth is left out: " + path("r.mkv") + " has no calibration"));
    EXPECT_TRUE(pictures("r.mcap", "b") == pictures("r.mkv", "a"));
    const Outcome asked = export_to("s.mcap", "r.mkv", {"--contents", "raw,points"});
    EXPECT_EQ(asked.exit_code, 2);
    EXPECT_THAT(asked.err, HasSubstr("--contents points: "));
    EXPECT_FALSE(std::filesystem::exists(path("s.mcap")));
}

TEST_F(McapExportTest, RawAloneIsWrittenWithoutMatching) {
    record("r.mkv");
    ASSERT_EQ(copy_to("r.mcap", "r.mkv", {"--contents", "raw,imu,tf", "--camera-name", "front"}).exit_code, 0);
    ASSERT_EQ(export_to("s.mcap", "r.mkv", {"--contents", "raw,imu,tf,disparity", "--camera-name", "front"}).exit_code,
              0);
    auto matched = topics_in(path("s.mcap"));
    matched.erase("/front/disparity");
    const auto raw = topics_in(path("r.mcap"));
    EXPECT_EQ(raw.size(), 6U);
    ASSERT_EQ(raw.size(), matched.size());
    for (const auto& [name, topic] : raw) {
        EXPECT_TRUE(topic.data == matched.at(name).data && topic.numbers == matched.at(name).numbers) << name;
    }
}

/// What the matrix of a turn is, as /tf_static has it.
std::array<double, 9> matrix_of(const std::array<double, 4>& turn) {
    const auto& [x, y, z, w] = turn;
    return {1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),
            2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
            2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y)};
}

TEST_F(McapExportTest, TheFirstCorrectionIsInTransformsToo) {
    record("r.mkv", {}, [](int, capture::RawFrame& frame) { frame.correction.roll_nrad = 20'000'000; });
    const std::string turned = "stereo_left_raw_optical_frame";
    std::set<std::array<double, 4>> found;
    for (const char* contents : {"raw,tf", "raw,disparity,tf"}) {
        const std::string file = "a" + std::to_string(found.size()) + ".mcap";
        ASSERT_EQ(copy_to(file, "r.mkv", {"--contents", contents}).exit_code, 0);
        auto topics = topics_in(path(file));
        found.insert(topics["/tf_static"].turns.at(turned));
        const std::array<double, 9> matrix = matrix_of(topics["/tf_static"].turns.at(turned));
        EXPECT_THAT(topics["/stereo/left/camera_info"].numbers["r"],
                    testing::Pointwise(testing::DoubleNear(1e-9), matrix));
    }
    EXPECT_EQ(found.size(), 1U);
    ASSERT_EQ(copy_to("b.mcap", "r.mkv", {"--contents", "raw,tf", "--no-self-calibration"}).exit_code, 0);
    EXPECT_NE(topics_in(path("b.mcap"))["/tf_static"].turns.at(turned), *found.begin());
}

TEST_F(McapExportTest, ADamagedCorrectionIsTold) {
    record("r.mkv", {}, [](int i, capture::RawFrame& frame) { frame.correction.pitch_nrad = i == 2 ? 53'000'000 : 0; });
    for (const char* contents : {"raw", "disparity"}) {
        const Outcome outcome = copy_to(std::string(contents) + ".mcap", "r.mkv", {"--contents", contents});
        EXPECT_EQ(outcome.exit_code, 1) << contents;
        EXPECT_THAT(outcome.err, HasSubstr("the recorded correction of the calibration is damaged")) << contents;
    }
    EXPECT_EQ(topics_in(path("raw.mcap")).at("/stereo/left/image_raw").messages, 2);
}

TEST_F(McapExportTest, SamplesOfDamagedFramesAreKept) {
    record("r.mkv", {}, [](int i, capture::RawFrame& frame) {
        frame.flags |= i == 0 || i == frames - 1 ? std::uint32_t{capture::frame_flag_corrupt} : 0U;
    });
    for (const char* contents : {"raw,imu", "raw,imu,disparity"}) {
        const std::string file = std::string(contents) + ".mcap";
        ASSERT_EQ(copy_to(file, "r.mkv", {"--contents", contents}).exit_code, 0);
        const auto topics = topics_in(path(file));
        EXPECT_EQ(topics.at("/stereo/left/image_raw").messages, frames - 2) << contents;
        EXPECT_EQ(topics.at("/stereo/imu/data_raw").messages, frames) << contents;
    }
}

/// Before a daemon is asked.
TEST_F(McapExportTest, ALimitOfFramesNeedsFrames) {
    const Outcome outcome =
        run(DISPARITYCTL, {"record", "--mcap", path("r.mcap"), "--contents", "imu,tf", "--frames", "3"});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("--frames: found with --contents of which no frame comes, allowed: --seconds"));
}

TEST_F(McapExportTest, RefusesInOneLine) {
    record("r.mkv");
    const auto refusal = [&](std::vector<std::string> more) {
        const Outcome outcome = export_to("r.mcap", "r.mkv", std::move(more));
        EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
        return outcome.err;
    };
    EXPECT_THAT(refusal({"--contents", "raw,deep"}), HasSubstr("--contents: found 'deep', allowed"));
    EXPECT_THAT(refusal({"--contents", "raw,rectified", "--size", "64x48"}), HasSubstr("--contents: found raw and"));
    EXPECT_THAT(refusal({"--scan-set", "sectors=9"}), HasSubstr("--scan-set: is given without --contents scan"));
    EXPECT_THAT(refusal({"--camera-name", "a b"}), HasSubstr("--camera-name: found 'a b'"));
    write_text(path("r.mcap"), "somebody's");
    EXPECT_THAT(refusal({}), HasSubstr("r.mcap: exists already"));
    EXPECT_EQ(read_file(path("r.mcap")), "somebody's");
    EXPECT_EQ(copy_to("r.mcap", "r.mkv", {"--force", "--contents", "raw"}).exit_code, 0);
    const std::string before = read_file(path("r.mcap"));
    std::filesystem::create_hard_link(path("r.mcap"), path("s.mcap"));
    const std::string topics = "?left=/stereo/left/image_raw&right=/stereo/right/image_raw";
    for (const std::string& source : {path("r.mcap"), path("r.mcap") + topics, path("s.mcap") + topics}) {
        const Outcome itself = run(DISPARITYCTL, {"export", source, "--mcap", path("r.mcap"), "--force"});
        EXPECT_EQ(itself.exit_code, 2);
        EXPECT_THAT(itself.err, HasSubstr("is the source itself"));
        const Outcome recorded = run(DISPARITYCTL, {"record", "--source", source, path("r.mcap"), "--force"});
        EXPECT_THAT(recorded.err, HasSubstr("is the source itself"));
    }
    EXPECT_TRUE(read_file(path("r.mcap")) == before);

    // What only matching uses.
    for (const std::vector<std::string>& option : std::vector<std::vector<std::string>>{
             {"--size", "64x48"}, {"--self-calibrate"}, {"--max-distance-m", "9"}, {"--disparities", "32"}}) {
        std::vector<std::string> more{"--contents", "raw,imu,tf"};
        more.insert(more.end(), option.begin(), option.end());
        const Outcome outcome = copy_to("t.mcap", "r.mkv", more);
        EXPECT_EQ(outcome.exit_code, 2);
        EXPECT_THAT(outcome.err, HasSubstr(option.front() + ": is given with --contents that"));
    }
    EXPECT_EQ(copy_to("t.mcap", "r.mkv", {"--contents", "raw", "--frames", "1"}).exit_code, 0);
}

}  // namespace
}  // namespace disparityd::test
