// SPDX-License-Identifier: Apache-2.0
//
// Folders of EuRoC and TUM-VI: pairs and times by data.csv, and the calibration beside them.
#include "capture/images/euroc_folder.h"

#include <cstdlib>
#include <filesystem>
#include <random>
#include <vector>

#include "capture/recording/recording_writer.h"
#include "tests/calibration/calibration_texts.h"
#include "tests/capture/images/image_fixture.h"
#include "tests/capture/recording/record_fixture.h"
#include "tests/data_folder.h"

namespace disparityd::capture {
namespace {

namespace fs = std::filesystem;

using calibration::test::camchain;
using calibration::test::euroc_sensor;
using calibration::test::Rig;
using calibration::test::with_other;
using test::refusal;
using test::TemporaryFolder;
using test::write_file;
using testing::HasSubstr;

constexpr const char* list_of_three =
    "#timestamp "
    "[ns],filename\r\n1520530308199447626,a.png\r\n1520530308249448034,b.png\r\n1520530308299448626,c.png\r\n";

/// mav0 with three images of 48 x 40 for each eye, whose names are no times.
class EurocFolder : public testing::Test {
protected:
    EurocFolder() {
        rig_.width = 48;
        rig_.height = 40;
        rig_.left = {40, 40, 24, 20};
        rig_.right = {40, 40.5, 23, 20.5};
        rig_.left_distortion = rig_.right_distortion = {-0.02, 0.003, 0.0001, -0.0002, 0};
        for (const int eye : {0, 1}) {
            fs::create_directories(camera(eye) + "/data");
            for (const char* name : {"a.png", "b.png", "c.png"}) {
                test::write_image(camera(eye) + "/data/" + name, test::numbered_image(48, 40, CV_8UC1, eye));
            }
            write_file(camera(eye) + "/data.csv", list_of_three);
            write_file(camera(eye) + "/sensor.yaml", euroc_sensor(rig_, eye));
        }
    }
    std::string camera(int eye) const { return folder_.file("mav0/cam" + std::to_string(eye)); }
    std::unique_ptr<FrameSource> open(const std::string& parameters = "") const {
        SourceOptions options;
        options.uri = folder_.file("") + parameters;
        options.pace = Pace::fastest;
        return open_source(options);
    }
    TemporaryFolder folder_;
    Rig rig_;
};

TEST_F(EurocFolder, TimesComeFromTheListAndTheCalibrationFromSensorYaml) {
    for (const std::string& name : {folder_.file(""), folder_.file("mav0")}) {
        const auto found = find_euroc(name);
        ASSERT_TRUE(found);
        ASSERT_EQ(found->frames.size(), 3U);
        EXPECT_EQ(found->frames[1].time_ns, 1520530308249448034);
        EXPECT_EQ(fs::path(found->frames[2].right).filename(), "c.png");
        EXPECT_TRUE(found->timed);
        EXPECT_EQ(found->unpaired, "");
    }
    const auto source = open();
    ASSERT_TRUE(source->info().calibration);
    EXPECT_EQ(source->info().calibration->right.cy, 20.5);
    EXPECT_NEAR(source->info().calibration->translation[0], -120, 1e-9);
    EXPECT_FALSE(find_euroc(camera(0)));
}

TEST_F(EurocFolder, ImagesOfOneEyeAreSkippedAndCounted) {
    write_file(camera(0) + "/data.csv", "1,a.png\n2,b.png\n3,c.png\n9,gone.png\n");
    write_file(camera(1) + "/data.csv", "1,a.png\n2,gone.png\n4,c.png\n9,gone.png\n");
    const auto found = find_euroc(folder_.file(""));
    ASSERT_TRUE(found);
    ASSERT_EQ(found->frames.size(), 1U);
    EXPECT_EQ(found->frames[0].time_ns, 1);
    EXPECT_THAT(found->unpaired, HasSubstr("1 pair; skipped are 2 images of the left eye alone, 1 of the right eye "
                                           "alone, and 1 time without an image"));
    write_file(camera(1) + "/data.csv", "5,a.png\n");
    EXPECT_THAT(refusal([&] { find_euroc(folder_.file("")); }), HasSubstr("mav0: found no two images"));
}

TEST_F(EurocFolder, ADamagedListIsRefusedInOneLine) {
    for (const auto& [line, said] : {std::pair("x,a.png", "data.csv:2: found 'x,a.png', expected the time in ns"),
                                     {"12", "data.csv:2: found '12'"},
                                     {"12,", "data.csv:2: found '12,'"},
                                     {"12,../a.png", "data.csv:2: found"},
                                     {"99999999999999999999,a.png", "data.csv:2: found"},
                                     {"9999999999999999999,a.png", "data.csv:2: found"},
                                     {"3,a.png\n3,b.png", "data.csv:3: found the time 3, expected more than 3"}}) {
        write_file(camera(1) + "/data.csv", std::string("#time\n") + line + "\n");
        EXPECT_THAT(refusal([&] { find_euroc(folder_.file("")); }), HasSubstr(said));
    }
}

TEST_F(EurocFolder, TumViHasItsCalibrationInDso) {
    fs::remove(camera(0) + "/sensor.yaml");
    EXPECT_EQ(find_euroc(folder_.file(""))->calibration, "");
    fs::create_directories(folder_.file("dso"));
    std::string chain = camchain(rig_);
    for (int eye = 0; eye < 2; ++eye) {
        chain = with_other(chain, "radtan", "equidistant");
    }
    write_file(folder_.file("dso/camchain.yaml"), chain);
    write_file(folder_.file("dso/imu_config.yaml"), "gyroscope_noise_density: 0.00008\nupdate_rate: 200.0\n");
    const auto source = open();
    ASSERT_TRUE(source->info().calibration);
    EXPECT_EQ(source->info().calibration->left.lens, calibration::LensModel::fisheye);
    EXPECT_EQ(source->info().calibration->inertial.gyroscope_noise_density, 8e-5);
}

/// A sample of the list: its values tell its number.
std::string sample_line(std::int64_t time_ns, int number) {
    return std::to_string(time_ns) + ",0." + std::to_string(number) + ",-1e-1,0.25,9.5,-0.5," + std::to_string(number) +
           "\n";
}

constexpr std::int64_t frame_ns[3] = {1520530308199447626, 1520530308249448034, 1520530308299448626};

/// Samples 1 and 2 until the first frame and with it, 3 until the second one, 4 and 5 until the third, 6 after it.
std::string list_of_samples() {
    std::string text = "\xEF\xBB\xBF#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1]\r\n";
    int number = 0;
    for (const std::int64_t ns : {frame_ns[0] - 5'000'000, frame_ns[0], frame_ns[0] + 5'000'000, frame_ns[1] + 1,
                                  frame_ns[2], frame_ns[2] + 1}) {
        text += sample_line(ns, ++number);
    }
    return text;
}

struct PlayedFrame {
    std::int64_t monotonic_ns = 0;
    std::int64_t realtime_ns = 0;
    std::vector<SensorSample> samples;

    bool operator==(const PlayedFrame&) const = default;
};

/// Plays so many frames.
std::vector<PlayedFrame> play_frames(FrameSource& source, std::size_t count) {
    std::vector<PlayedFrame> frames;
    RawFrame frame;
    while (frames.size() < count &&
           source.next(frame, std::chrono::steady_clock::time_point::max()) == FrameSource::Next::frame) {
        frames.push_back({frame.monotonic_ns, frame.realtime_ns, {frame.sensors.begin(), frame.sensors.end()}});
        source.give_back(frame);
    }
    return frames;
}

/// Returns the numbers that sample_line() gave the samples of each frame.
std::vector<std::vector<int>> numbers_of(const std::vector<PlayedFrame>& frames) {
    std::vector<std::vector<int>> numbers;
    for (const PlayedFrame& frame : frames) {
        numbers.emplace_back();
        for (const SensorSample& sample : frame.samples) {
            numbers.back().push_back(static_cast<int>(sample.acceleration.z));
        }
    }
    return numbers;
}

using Numbers = std::vector<std::vector<int>>;

TEST_F(EurocFolder, SamplesOfTheSensorComeWithTheFrameThatFollowsThem) {
    fs::create_directories(folder_.file("mav0/imu0"));
    write_file(folder_.file("mav0/imu0/data.csv"), list_of_samples());
    const auto source = open();
    EXPECT_THAT(source->info().description, HasSubstr("with imu0"));
    const std::vector<PlayedFrame> frames = play_frames(*source, 4);
    ASSERT_EQ(numbers_of(frames), (Numbers{{1, 2}, {3}, {4, 5}}));
    const SensorSample& sample = frames[0].samples[0];
    EXPECT_EQ(sample.camera_ns, frame_ns[0] - 5'000'000);
    EXPECT_EQ(sample.monotonic_ns, -5'000'000) << "the first frame is at 0";
    EXPECT_EQ(sample.realtime_ns, frame_ns[0] - 5'000'000);
    EXPECT_EQ(sample.flags, static_cast<std::uint32_t>(sensor_flag_inertial));
    EXPECT_EQ(sample.lost_before, 0U);
    EXPECT_EQ(sample.angular_velocity, (SensorVector{0.1F, -0.1F, 0.25F}));
    EXPECT_EQ(sample.acceleration, (SensorVector{9.5F, -0.5F, 1}));
    EXPECT_EQ(frames[0].samples[1].monotonic_ns, frames[0].monotonic_ns);
    EXPECT_EQ(frames[2].samples[1].realtime_ns, frames[2].realtime_ns);
    EXPECT_EQ(play_frames(*open(), 4), frames) << "the same every time";
}

TEST_F(EurocFolder, SamplesBeginAnewWithEachRoundAndAfterTheImageBefore) {
    fs::create_directories(folder_.file("mav0/imu0"));
    write_file(folder_.file("mav0/imu0/data.csv"), list_of_samples());
    SourceOptions options;
    options.uri = folder_.file("");
    options.pace = Pace::fastest;
    options.loop = true;
    EXPECT_EQ(numbers_of(play_frames(*open_source(options), 5)), (Numbers{{1, 2}, {3}, {4, 5}, {1, 2}, {3}}));
    options.first_image = 1;
    options.image_count = 1;
    EXPECT_EQ(numbers_of(play_frames(*open_source(options), 2)), (Numbers{{3}, {3}}));
    // A damaged frame that is left out leaves its samples to the next one, also where a round begins with it.
    options.first_image = 0;
    options.image_count = SIZE_MAX;
    options.skip_damaged = true;
    write_file(camera(0) + "/data/a.png", "no image");
    EXPECT_EQ(numbers_of(play_frames(*open_source(options), 3)), (Numbers{{1, 2, 3}, {4, 5}, {1, 2, 3}}));
}

TEST_F(EurocFolder, OfMoreSamplesThanAFrameCarriesTheNewestStay) {
    fs::create_directories(folder_.file("mav0/imu0"));
    std::string text;
    constexpr int count = 3000;
    for (int i = 0; i < count; ++i) {
        text += sample_line(frame_ns[0] - count + i, i);
    }
    write_file(folder_.file("mav0/imu0/data.csv"), text);
    const std::vector<PlayedFrame> frames = play_frames(*open(), 1);
    ASSERT_EQ(frames[0].samples.size(), RawFrame::most_samples);
    EXPECT_EQ(frames[0].samples[0].lost_before, count - RawFrame::most_samples);
    for (std::size_t i = 0; i < RawFrame::most_samples; ++i) {
        ASSERT_EQ(frames[0].samples[i].acceleration.z, static_cast<float>(count - RawFrame::most_samples + i));
        ASSERT_EQ(frames[0].samples[i].lost_before, i == 0 ? count - RawFrame::most_samples : 0);
    }
}

TEST_F(EurocFolder, ADamagedListOfSamplesEndsTheSourceInOneLine) {
    fs::create_directories(folder_.file("mav0/imu0"));
    for (const auto& [line, said] :
         {std::pair(std::string("5,1,2,3,4,5"), "data.csv:2: found '5,1,2,3,4,5', expected the time in ns, the"),
          {"5,1,2,3,4,5,6,7", "data.csv:2: found"},
          {"5,1,2,3,4,5,nan", "data.csv:2: found"},
          {"5,1,2,3,4,5,1e40", "data.csv:2: found"},
          {"-5,1,2,3,4,5,6", "data.csv:2: found"},
          {"5,1,2,3,4,5,6\n5,1,2,3,4,5,6", "data.csv:3: found the time 5, expected more than 5"},
          {std::string("5,1,2,3,4,5,6\0", 14) + "\n", "data.csv:2: found"},
          {std::string(100'000, '1'), "data.csv:2: found a line of more than 511 bytes"}}) {
        write_file(folder_.file("mav0/imu0/data.csv"), "#time\n" + line + "\n");
        const auto source = open();
        RawFrame frame;
        const auto next = [&] { return source->next(frame, std::chrono::steady_clock::time_point::max()); };
        EXPECT_THAT(next, testing::ThrowsMessage<std::runtime_error>(HasSubstr(said)));
        EXPECT_EQ(next(), FrameSource::Next::end);
    }
}

TEST_F(EurocFolder, DamagedFilesOfTheSensorAreLeftOutWhenAskedFor) {
    fs::create_directories(folder_.file("mav0/imu0"));
    write_file(folder_.file("mav0/imu0/data.csv"), "#time\n5,1,2,3\n");
    write_file(folder_.file("mav0/imu0/sensor.yaml"), "sensor_type: imu\ngyroscope_noise_density: many\n");
    EXPECT_THAT(refusal([&] { open(); }), HasSubstr("?imu=off behind the folder plays its images without"));
    write_file(folder_.file("mav0/imu0/sensor.yaml"), "sensor_type: imu\ngyroscope_noise_density: 0.0002\n");
    EXPECT_THAT([&] { play_frames(*open(), 1); },
                testing::ThrowsMessage<std::runtime_error>(HasSubstr("?imu=off behind the folder plays its images")));
    EXPECT_EQ(open()->info().calibration->inertial.gyroscope_noise_density, 0.0002);
    for (const char* parameters : {"?imu=off", "?imu=off&bits=12", "?bits=12&imu=off"}) {
        const auto source = open(parameters);
        EXPECT_THAT(source->info().description, testing::Not(HasSubstr("imu0")));
        ASSERT_TRUE(source->info().calibration);
        EXPECT_FALSE(source->info().calibration->inertial.is_known());
        EXPECT_EQ(numbers_of(play_frames(*source, 4)), (Numbers{{}, {}, {}}));
    }
    EXPECT_THAT(refusal([&] { open("?imu=on"); }), HasSubstr("imu: found 'on', allowed is off"));
    EXPECT_THAT(refusal([&] { open("?imu=off&bitz=12"); }), HasSubstr("found 'bitz=12', allowed are bits=9 to 16"));
    // What is wrong with a camera is no matter of the sensor.
    write_file(camera(0) + "/sensor.yaml", "sensor_type: camera\n");
    EXPECT_THAT(refusal([&] { open(); }), testing::Not(HasSubstr("imu=off")));
}

TEST_F(EurocFolder, ARecordingKeepsSamplesAndWhereTheSensorStands) {
    fs::create_directories(folder_.file("mav0/imu0"));
    write_file(folder_.file("mav0/imu0/data.csv"), list_of_samples());
    write_file(folder_.file("mav0/imu0/sensor.yaml"),
               "sensor_type: imu\nT_BS: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\n"
               "accelerometer_random_walk: 0.003\n");
    const auto source = open();
    const std::string path = folder_.file("recording.mkv");
    RecordingWriter writer(path, source->info());
    RawFrame frame;
    while (source->next(frame, std::chrono::steady_clock::time_point::max()) == FrameSource::Next::frame) {
        writer.write(frame);
        source->give_back(frame);
    }
    writer.close();
    SourceOptions options;
    options.uri = path;
    options.pace = Pace::fastest;
    const auto replay = open_source(options);
    EXPECT_EQ(play_frames(*replay, 4), play_frames(*open(), 4));
    ASSERT_TRUE(replay->info().calibration);
    EXPECT_TRUE(replay->info().calibration->inertial.to_left_camera);
    EXPECT_EQ(replay->info().calibration->inertial, source->info().calibration->inertial);
}

/// Damages a file in one of many ways: bytes changed, cut, doubled.
std::string damaged(std::string text, std::mt19937& random) {
    const auto place = [&] { return random() % text.size(); };
    for (std::uint32_t i = 0, count = 1 + random() % 4; i < count && !text.empty(); ++i) {
        switch (random() % 4) {
            case 0: text[place()] = static_cast<char>(random()); break;
            case 1: text.resize(place()); break;
            case 2: text.insert(place(), text.substr(place(), random() % 60)); break;
            default: text.erase(place(), random() % 20);
        }
    }
    return text;
}

TEST_F(EurocFolder, DamagedFilesGiveALineOrFrames) {
    std::mt19937 random(7);
    fs::create_directories(folder_.file("mav0/imu0"));
    for (const auto& [file, text] :
         {std::pair("/data.csv", std::string(list_of_three)),
          {"/sensor.yaml", euroc_sensor(rig_, 0)},
          {"/../imu0/data.csv", list_of_samples()},
          {"/../imu0/sensor.yaml", "sensor_type: imu\nrate_hz: 200\ngyroscope_noise_density: 1.6968e-04\n"}}) {
        int refused = 0;
        for (int i = 0; i < 300; ++i) {
            write_file(camera(0) + file, damaged(text, random));
            try {
                const auto source = open();
                EXPECT_EQ(source->info().eye_width, 48);
                play_frames(*source, 3);
            } catch (const std::exception& error) {
                EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
                ++refused;
            }
        }
        EXPECT_GT(refused, 50) << file;
        write_file(camera(0) + file, text);
    }
}

TEST(EurocData, RealFoldersAreReadWithTheirCalibration) {
    const fs::path folder = disparityd::test::data_folder() / "euroc";
    if (!fs::exists(folder / "mav0")) {
        GTEST_SKIP() << "no EuRoC images in " << folder << "; DISPARITYD_DATA names the folder";
    }
    SourceOptions options;
    options.uri = folder.string();
    options.pace = Pace::fastest;
    const auto source = open_source(options);
    ASSERT_TRUE(source->info().calibration);
    const auto& t = source->info().calibration->translation;
    EXPECT_NEAR(std::sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]), 110.1, 0.1);
    EXPECT_EQ(find_euroc(options.uri)->frames.size(), 8U);
    std::size_t samples = 0;
    for (const PlayedFrame& frame : play_frames(*source, 8)) {
        samples += frame.samples.size();
    }
    EXPECT_EQ(samples, 71U) << "200 a second over seven frames of 20 a second, and that of the first frame";
    // The sensor's axes are those of the body there, so that T_cam_imu leads back what T_BS of cam0 does.
    const calibration::InertialCalibration& inertial = source->info().calibration->inertial;
    ASSERT_TRUE(inertial.to_left_camera);
    const calibration::Pose back = calibration::inverse(*inertial.to_left_camera);
    EXPECT_NEAR(back.translation[0], -21.64, 0.01);
    EXPECT_NEAR(back.translation[1], -64.68, 0.01);
    EXPECT_NEAR(back.translation[2], 9.81, 0.01);
    EXPECT_NEAR(back.rotation[3], 0.99956, 1e-5);
    EXPECT_EQ(inertial.gyroscope_noise_density, 1.6968e-4);
    EXPECT_EQ(inertial.gyroscope_random_walk, 1.9393e-5);
    EXPECT_EQ(inertial.accelerometer_noise_density, 2e-3);
    EXPECT_EQ(inertial.accelerometer_random_walk, 3e-3);
    EXPECT_FALSE(inertial.time_offset_s);
    const auto fisheye = calibration::read_calibration((folder / "fisheye/left_sensor_fisheye.yaml").string() + "," +
                                                           (folder / "fisheye/right_sensor_fisheye.yaml").string(),
                                                       752, 480);
    EXPECT_EQ(fisheye.right.lens, calibration::LensModel::fisheye);
}

}  // namespace
}  // namespace disparityd::capture
