// SPDX-License-Identifier: Apache-2.0
//
// The tools and the daemon on each kind of source. All hold the same pixels and the same calibration, so that all must
// give the same bytes as a folder of PNGs.
#include <filesystem>
#include <functional>

#include <disparity_client.hpp>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <signal.h>
#include <unistd.h>

#include "capture/recording/recording_writer.h"
#include "tests/calibration/board/drawn_board.h"
#include "tests/capture/bag/bag_fixture.h"
#include "tests/capture/played_source.h"
#include "tests/formats/db3_writer.h"
#include "tests/formats/ros1_writer.h"
#include "tests/formats/svo2_writer.h"
#include "tests/tools/made_input.h"
#include "tests/tools/run_program.h"

namespace disparityd::test {
namespace {

namespace fs = std::filesystem;

using capture::test::play_all;
using capture::test::Played;
using testing::HasSubstr;

constexpr int width = 320;
constexpr int height = 180;
constexpr int source_frames = 3;
constexpr std::int64_t source_period_ns = 50'000'000;
const calibration::Board board{9, 6, 30};

/// Numbers that all formats can write exactly.
calibration::StereoCalibration cameras() {
    calibration::StereoCalibration calibration;
    calibration.width = width;
    calibration.height = height;
    calibration.left.fx = calibration.left.fy = 256;
    calibration.left.cx = 160;
    calibration.left.cy = 90;
    calibration.right = calibration.left;
    calibration.translation = {-125, 0, 0};
    return calibration;
}

std::string euroc_camera(int eye) {
    return "sensor_type: camera\nT_BS: [1, 0, 0, " + std::string(eye == 0 ? "0" : "0.125") +
           ", 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\nresolution: [320, 180]\ncamera_model: pinhole\n"
           "intrinsics: [256, 256, 160, 90]\ndistortion_model: radial-tangential\n"
           "distortion_coefficients: [0, 0, 0, 0]\n";
}

CameraInfoFields camera_info(bool left) {
    CameraInfoFields info;
    info.width = width;
    info.height = height;
    info.distortion = {0, 0, 0, 0, 0};
    info.k = {256, 0, 160, 0, 256, 90, 0, 0, 1};
    info.p = {256, 0, 160, 0, 0, 256, 90, 0, 0, 0, 1, 0};
    return left ? info : info.right_of(0.125);
}

struct Source {
    std::string name;
    std::string uri;
    bool has_samples = false;
    bool needs_calibration = false;
};

/// What the tools and the daemon have made of a source.
struct Made {
    std::map<std::string, std::string> files;
    nlohmann::json estimates;
    std::string calibration;
    std::vector<std::uint8_t> depth;
};

class EachSourceTest : public FolderTest {
protected:
    void SetUp() override {
        FolderTest::SetUp();
        const calibration::test::BoardPainter painter(cameras(), board);
        const auto poses = calibration::test::careful_poses(board);
        for (int i = 0; i < source_frames; ++i) {
            pictures_.push_back(painter.draw(poses.at(poses.size() - source_frames - 1 + static_cast<std::size_t>(i))));
        }
        write_text(path("cameras.yml"), to_opencv_yaml(cameras()));
    }

    static std::int64_t stamp(int frame) { return bag_start_ns + frame * source_period_ns; }

    cv::Mat eye(int frame, bool left) const {
        auto* pixels = const_cast<std::uint8_t*>(pictures_[static_cast<std::size_t>(frame)].data());
        return cv::Mat(height, 2 * width, CV_8U, pixels).colRange(left ? 0 : width, left ? width : 2 * width);
    }

    /// The pixels of both eyes as PNGs, whose names are the times of the frames.
    Source png_folder(const std::string& name, const std::function<cv::Mat(int, bool)>& pixels) const {
        for (const bool left : {true, false}) {
            const std::string folder = path(name) + (left ? "/left/" : "/right/");
            fs::create_directories(folder);
            for (int i = 0; i < source_frames; ++i) {
                EXPECT_TRUE(cv::imwrite(folder + std::to_string(stamp(i)) + ".png", pixels(i, left)));
            }
        }
        return {name, path(name), false, true};
    }

    Source euroc() const {
        for (const int camera : {0, 1}) {
            const std::string folder = path("euroc/mav0/cam") + std::to_string(camera);
            fs::create_directories(folder + "/data");
            std::string list;
            for (int i = 0; i < source_frames; ++i) {
                list += std::to_string(stamp(i)) + "," + std::to_string(i) + ".png\n";
                EXPECT_TRUE(cv::imwrite(folder + "/data/" + std::to_string(i) + ".png", eye(i, camera == 0)));
            }
            write_text(folder + "/data.csv", list);
            write_text(folder + "/sensor.yaml", euroc_camera(camera));
        }
        fs::create_directories(path("euroc/mav0/imu0"));
        write_text(path("euroc/mav0/imu0/data.csv"), std::to_string(stamp(1) - 5) + ",0.1,0.2,0.3,0,9.8,0\n");
        return {"EuRoC", path("euroc"), true};
    }

    /// A recording, with the frames as they are or as JPEGs of a camera.
    Source recording(const std::string& name, bool jpegs) const {
        capture::SourceInfo info;
        info.name = "made";
        info.format = jpegs ? PixelFormat::yuyv : PixelFormat::grey8;
        info.eye_width = width;
        info.height = height;
        info.rate = 20;
        info.calibration = cameras();
        if (jpegs) {
            info.jpegs = capture::EyeLayout{width, height};
        }
        capture::RecordingWriter writer(path(name), info);
        for (int i = 0; i < source_frames; ++i) {
            const auto& picture = pictures_[static_cast<std::size_t>(i)];
            std::vector<std::uint8_t> jpeg;
            const cv::Mat both(height, 2 * width, CV_8U, const_cast<std::uint8_t*>(picture.data()));
            EXPECT_TRUE(cv::imencode(".jpg", both, jpeg));
            capture::RawFrame frame;
            const std::vector<std::uint8_t> yuyv(jpegs ? 2 * picture.size() : 0);
            frame.image = {jpegs ? yuyv.data() : picture.data(), info.format, width, height,
                           std::ptrdiff_t{jpegs ? 4 : 2} * width};
            frame.jpeg = jpegs ? std::span<const std::uint8_t>(jpeg) : frame.jpeg;
            frame.sequence = static_cast<std::uint64_t>(i);
            frame.monotonic_ns = i * source_period_ns;
            frame.realtime_ns = stamp(i);
            capture::SensorSample sample;
            sample.flags = capture::sensor_flag_inertial;
            frame.sensors = {&sample, 1};
            writer.write(frame);
        }
        writer.close();
        return {name, path(name), true};
    }

    Source mcap_bag(const std::string& name, const std::string& images, const std::string& lens = "plumb_bob") const {
        BagWriter bag;
        for (int i = 0; i < source_frames; ++i) {
            bag.imu("/imu", stamp(i), 0.5, 9.8);
            for (const bool left : {true, false}) {
                const std::string topic = left ? "/left/" : "/right/";
                CameraInfoFields info = camera_info(left);
                info.model = lens;
                if (!lens.empty()) {
                    bag.camera_info(topic + "camera_info", stamp(i), info);
                }
                bag.image(topic + images, stamp(i), eye(i, left), "mono8");
            }
        }
        write_text(path(name), bag.close());
        return {name, path(name), true};
    }

    Source db3_bag(const Source& mcap) const {
        write_db3(mcap.uri, path("bag.db3"));
        return {"bag.db3", path("bag.db3"), true};
    }

    Source ros1_bag() const {
        Ros1Writer bag("lz4");
        std::map<bool, std::uint32_t> images, infos;
        for (const bool left : {true, false}) {
            const std::string topic = left ? "/left/" : "/right/";
            images[left] = bag.connection(topic + "image_raw", "sensor_msgs/Image", std::string(ros1_image_type));
            infos[left] =
                bag.connection(topic + "camera_info", "sensor_msgs/CameraInfo", std::string(ros1_camera_info_type));
        }
        for (int i = 0; i < source_frames; ++i) {
            for (const bool left : {true, false}) {
                bag.message(infos[left], stamp(i), ros1_camera_info(stamp(i), camera_info(left)));
                bag.message(images[left], stamp(i), ros1_image(stamp(i), eye(i, left).clone()));
            }
        }
        write_text(path("ros1.bag"), bag.close());
        return {"ros1.bag", path("ros1.bag")};
    }

    Source svo2() const {
        Svo2File file;
        file.payload = Svo2Payload::zstd_grey;
        file.eye_width = width;
        file.height = height;
        file.frames = source_frames;
        file.rate = 20;
        file.draw = [this](int frame) {
            return Svo2Picture{2 * width, height, pictures_[static_cast<std::size_t>(frame)], {}, {}};
        };
        write_text(path("zed.svo2"), svo2_bytes(file));
        return {"SVO2", path("zed.svo2"), true, true};
    }

    std::vector<std::string> calibrated(const Source& source, const std::string& option,
                                        std::vector<std::string> with) {
        if (source.needs_calibration) {
            with.insert(with.end(), {option, (option == "--set" ? "source.calibration=" : "") + path("cameras.yml")});
        }
        return with;
    }

    void expect_done(const Outcome& outcome) { ASSERT_EQ(outcome.exit_code, 0) << outcome.err; }

    void record(const Source& source) {
        const std::string file = path("recorded.mkv");
        expect_done(run(DISPARITYCTL,
                        calibrated(source, "--calibration", {"record", file, "--source", source.uri, "--force"})));
        capture::SourceOptions options;
        options.uri = source.uri;
        const Played played = play_all(options);
        options.uri = file;
        const Played again = play_all(options);
        EXPECT_EQ(played.problem + again.problem, "");
        ASSERT_EQ(played.frames.size(), static_cast<std::size_t>(source_frames));
        EXPECT_TRUE(again.frames == played.frames);
        EXPECT_EQ(again.times, played.times);
        EXPECT_EQ(again.sequences, played.sequences);
        EXPECT_EQ(again.samples, played.samples);
        EXPECT_EQ(again.samples.empty(), !source.has_samples);
        EXPECT_TRUE(again.info.calibration);
    }

    void process(const Source& source, Made& made) {
        const std::string folder = path("out");
        fs::remove_all(folder);
        const Outcome outcome = run(DISPARITYCTL, calibrated(source, "--calibration",
                                                             {"process", source.uri, "-o", folder, "--self-calibrate",
                                                              "--json", "--disparities", "128"}));
        expect_done(outcome);
        const auto summary = nlohmann::json::parse(outcome.out);
        made.estimates = summary["self_calibration"];
        EXPECT_EQ(summary["frames"], source_frames);
        EXPECT_GT(summary["measured"], 0.1);
        for (auto& [name, bytes] : files_in(folder)) {
            if (name != "geometry.json" && name != "manifest.json") {  // they name the source
                made.files.emplace(std::to_string(made.files.size()), std::move(bytes));
            }
        }
    }

    void calibrate(const Source& source, Made& made) {
        expect_done(run(DISPARITYCTL, {"calibrate", source.uri, "-o", path("found.yml"), "--square", "30", "--force"}));
        made.calibration = read_file(path("found.yml"));
    }

    /// Takes the depth of the last frame.
    void serve(const Source& source, Made& made) {
        const std::string name = "each-source-" + std::to_string(getpid()) + "-" + std::to_string(daemons_++);
        Program daemon(DISPARITYD, calibrated(source, "--set",
                                              {"--source", source.uri, "--name", name, "--self-calibrate", "--set",
                                               "socket.tcp=", "--set", "socket.unix=" + path("d.sock"), "--set",
                                               "match.disparities=128", "--set", "source.pace=fastest"}));
        disparity::SharedMemoryOptions options;
        options.may_be_absent = true;
        disparity::SharedMemoryReader memory(name, options);
        disparity::Frame frame;
        ASSERT_TRUE(eventually([&] {
            const bool read = memory.read(frame, std::chrono::milliseconds(100)) == disparity::ReadResult::frame;
            return (read && frame.publish_index == source_frames - 1) || !daemon.running();
        }));
        ASSERT_TRUE(daemon.running()) << daemon.wait().err;
        ASSERT_TRUE(frame.plane(disparity::Product::depth) != nullptr);
        made.depth = frame.plane(disparity::Product::depth)->bytes;
        daemon.send(SIGTERM);
        expect_done(daemon.wait());
    }

    Made make(const Source& source) {
        Made made;
        if (source.name != "luma") {  // which is like the other folder
            record(source);
        }
        process(source, made);
        calibrate(source, made);
        serve(source, made);
        return made;
    }

    std::vector<std::vector<std::uint8_t>> pictures_;
    int daemons_ = 0;
};

TEST_F(EachSourceTest, GivesTheBytesOfAFolderOfPngsFromEveryTool) {
    const Source jpegs = recording("jpegs.mkv", true);
    capture::SourceOptions options;
    options.uri = jpegs.uri;
    const Played played = play_all(options);
    const auto luma = [&](int frame, bool left) {
        auto* pixels = const_cast<std::uint8_t*>(played.frames.at(static_cast<std::size_t>(frame)).data());
        cv::Mat grey;
        cv::extractChannel(cv::Mat(height, 2 * width, CV_8UC2, pixels), grey, 0);
        return grey.colRange(left ? 0 : width, left ? width : 2 * width).clone();
    };
    const Source mcap = mcap_bag("bag.mcap", "image_raw");
    for (const std::vector<Source>&alike :
         {std::vector<Source>{png_folder("folder", [this](int i, bool left) { return eye(i, left); }), euroc(),
                              recording("frames.mkv", false), mcap, db3_bag(mcap), ros1_bag(), svo2()},
          {png_folder("luma", luma), jpegs}}) {
        std::optional<Made> expected;
        for (const Source& source : alike) {
            SCOPED_TRACE(source.name);
            const Made made = make(source);
            EXPECT_FALSE(made.depth.empty());
            EXPECT_FALSE(made.calibration.empty());
            EXPECT_GE(made.files.size(), static_cast<std::size_t>(source_frames));
            if (expected) {
                EXPECT_EQ(made.estimates, expected->estimates);
                EXPECT_EQ(made.calibration, expected->calibration);
                EXPECT_TRUE(made.depth == expected->depth);
                EXPECT_TRUE(made.files == expected->files);
            }
            expected = made;
        }
    }
}

TEST_F(EachSourceTest, WhatABagLacksIsToldAndACalibrationThatCannotBeUsedIsNotNeededToCalibrate) {
    const Source without = mcap_bag("without.mcap", "image_raw", "");
    const Outcome recorded = run(DISPARITYCTL, {"record", path("r.mkv"), "--source", without.uri});
    expect_done(recorded);
    EXPECT_THAT(recorded.err, HasSubstr("has no sensor_msgs/msg/CameraInfo beside the images"));
    const Source odd = mcap_bag("odd.mcap", "image_raw", "omni");
    const Outcome refused = run(DISPARITYCTL, {"process", odd.uri, "-o", path("out")});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err, HasSubstr("omni"));
    Made made;
    calibrate(odd, made);
    EXPECT_THAT(made.calibration, HasSubstr("M1"));
}

}  // namespace
}  // namespace disparityd::test
