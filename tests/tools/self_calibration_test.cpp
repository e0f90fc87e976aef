// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cstdio>
#include <fstream>
#include <functional>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "calibration/calibration_correction.h"
#include "capture/frame_source.h"
#include "capture/recording/recording_writer.h"
#include "tests/tools/made_input.h"
#include "tests/tools/run_program.h"
#include "tools/images/image_file.h"

namespace disparityd::test {
namespace {

using calibration::CalibrationCorrection;
using testing::AllOf;
using testing::HasSubstr;

constexpr CalibrationCorrection turned{4'000'000, 0, -3'000'000, 0};  // about 1.4 px and 0.2 degrees

CalibrationCorrection opposite(const CalibrationCorrection& correction) {
    return {-correction.pitch_nrad, -correction.yaw_nrad, -correction.roll_nrad, -correction.focal_ppb};
}

/// A recording of the rendered scene. `edit` changes what is known about it and each frame.
using Edit = std::function<void(capture::SourceInfo& info)>;
using EditFrame = std::function<void(capture::RawFrame& frame)>;
void record_scene(const std::string& path, int frames, const Edit& edit, const EditFrame& edit_frame = {}) {
    capture::SourceOptions options;
    options.uri = "scene:vga@15?loop=8&frames=" + std::to_string(frames);
    options.pace = capture::Pace::fastest;
    const auto source = capture::open_source(options);
    capture::SourceInfo info = source->info();
    edit(info);
    capture::RecordingWriter writer(path, info);
    capture::RawFrame frame;
    while (source->next(frame, std::chrono::steady_clock::now() + std::chrono::minutes(1)) ==
           capture::FrameSource::Next::frame) {
        capture::RawFrame written = frame;
        if (edit_frame) {
            edit_frame(written);
        }
        writer.write(written);
        source->give_back(frame);
    }
    writer.close();
}

void misjudge(capture::SourceInfo& info) {
    info.calibration = corrected(*info.calibration, opposite(turned));
}

class SelfCalibrationTest : public FolderTest {
protected:
    Outcome process(const std::string& in, const std::string& out, std::vector<std::string> options = {}) {
        std::vector<std::string> arguments{"process",       path(in), "-o",       path(out), "--json",
                                           "--disparities", "64",     "--method", "census"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        return run(DISPARITYCTL, arguments);
    }
};

TEST_F(SelfCalibrationTest, FindsTheTurnAndGivesTheSameBytesEveryTime) {
    record_scene(path("in.mkv"), 24, misjudge);
    const Outcome first = process("in.mkv", "first", {"--self-calibrate", "--workers", "1"});
    ASSERT_EQ(first.exit_code, 0) << first.err;
    const auto estimates = nlohmann::json::parse(first.out)["self_calibration"];
    ASSERT_FALSE(estimates.empty());
    EXPECT_EQ(estimates[0]["sequence"], 0);
    EXPECT_EQ(estimates[0]["accepted"], true);
    EXPECT_NEAR(estimates[0]["pitch_nrad"], turned.pitch_nrad, 350'000);  // 0.02 degrees
    EXPECT_NEAR(estimates[0]["roll_nrad"], turned.roll_nrad, 350'000);
    EXPECT_LT(estimates[0]["vertical_error_after_px"], 0.1);
    EXPECT_GT(estimates[0]["vertical_error_before_px"], 1);

    const auto pictures = files_in(path("first"));
    EXPECT_THAT(pictures.at("corrections.csv"), HasSubstr("\n0,0,"));
    const Outcome second = process("in.mkv", "second", {"--self-calibrate", "--workers", "3"});
    EXPECT_EQ(nlohmann::json::parse(second.out)["self_calibration"], estimates);
    EXPECT_EQ(files_in(path("second")), pictures);
    ASSERT_EQ(process("in.mkv", "without").exit_code, 0);
    EXPECT_NE(files_in(path("without")).at("000000.png"), pictures.at("000000.png"));
    EXPECT_EQ(files_in(path("without")).count("corrections.csv"), 0U);
}

TEST_F(SelfCalibrationTest, ShowsTheRowsBeforeAndAfter) {
    record_scene(path("in.mkv"), 2, misjudge);
    const std::vector<std::string> command{"rows", path("in.mkv"), "-o", path("rows.png"), "--disparities", "64"};
    const Outcome outcome = run(DISPARITYCTL, command);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto at = outcome.out.find("last frame ");
    ASSERT_NE(at, std::string::npos) << outcome.out;
    double before = 0;
    double after = 0;
    ASSERT_EQ(std::sscanf(outcome.out.c_str() + at, "last frame %lf px as calibrated, %lf px", &before, &after), 2);
    EXPECT_GT(before, 1);
    EXPECT_LT(after, 0.15);
    EXPECT_THAT(outcome.out, HasSubstr("wrong matches, which are left out"));
    EXPECT_THAT(outcome.out, HasSubstr("frame 0: corrected"));
    EXPECT_GT(images::read_image(path("rows.png")).rows, 4 * 90);

    EXPECT_THAT(run(DISPARITYCTL, command).err, HasSubstr("exists already"));
    make_recording(path("bare.mkv"), 2, 64, 48);
    EXPECT_THAT(run(DISPARITYCTL, {"rows", path("bare.mkv"), "-o", path("bare.png")}).err,
                HasSubstr("has no calibration"));
}

TEST_F(SelfCalibrationTest, AppliesWhatIsRecordedFromItsFrameOn) {
    record_scene(path("corrected.mkv"), 6, misjudge, [](capture::RawFrame& frame) {
        frame.correction = frame.sequence >= 3 ? turned : CalibrationCorrection{};
    });
    record_scene(path("factory.mkv"), 6, misjudge);
    record_scene(path("true.mkv"), 6, [](capture::SourceInfo& info) {
        misjudge(info);
        info.calibration = corrected(*info.calibration, turned);
    });
    for (const char* name : {"corrected", "factory", "true"}) {
        ASSERT_EQ(process(std::string(name) + ".mkv", name).exit_code, 0);
    }
    const auto by_recording = files_in(path("corrected"));
    const auto by_factory = files_in(path("factory"));
    const auto by_truth = files_in(path("true"));
    for (int i = 0; i < 6; ++i) {
        const std::string name = "00000" + std::to_string(i) + ".png";
        EXPECT_EQ(by_recording.at(name), (i < 3 ? by_factory : by_truth).at(name)) << i;
        EXPECT_NE(by_factory.at(name), by_truth.at(name)) << i;
    }
    EXPECT_THAT(by_recording.at("corrections.csv"), HasSubstr("\n3,3,4000000,0,-3000000,0,"));

    ASSERT_EQ(process("corrected.mkv", "off", {"--no-self-calibration"}).exit_code, 0);
    const auto off = files_in(path("off"));
    EXPECT_EQ(off.at("000005.png"), by_factory.at("000005.png"));
    EXPECT_EQ(off.count("corrections.csv"), 0U);
}

// The ranges are 0 to 2, 3 to 5 and 6 to 8: a damaged frame ends each, and a correction begins and ends within.
TEST_F(SelfCalibrationTest, RangesOfShardsAreJoinedWithCorrectionsAndLosses) {
    record_scene(path("in.mkv"), 9, misjudge, [](capture::RawFrame& frame) {
        frame.correction = frame.sequence >= 1 && frame.sequence < 7 ? turned : CalibrationCorrection{};
        frame.flags |= frame.sequence == 2 || frame.sequence == 5 ? capture::frame_flag_corrupt : 0U;
        frame.dropped_before = frame.sequence == 5 ? 3 : 0;
    });
    ASSERT_EQ(process("in.mkv", "whole", {"--no-trust"}).exit_code, 0);
    for (const char* const shard : {"2/3", "1/3", "0/3"}) {
        const Outcome outcome = process("in.mkv", "out", {"--no-trust", "--split", "--shard", shard});
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    }
    const auto whole = files_in(path("whole"));
    EXPECT_THAT(whole.at("corrections.csv"), AllOf(HasSubstr("\n1,1,4000000,"), HasSubstr("\n5,7,0,")));
    EXPECT_THAT(whole.at("manifest.json"), HasSubstr("\"dropped_before\":4"));
    EXPECT_EQ(files_in(path("out")), whole);
}

TEST_F(SelfCalibrationTest, ADamagedCorrectionEndsTheRunAndSaysWhatToDo) {
    record_scene(path("in.mkv"), 3, misjudge, [](capture::RawFrame& frame) {
        frame.correction.roll_nrad = frame.sequence >= 1 ? 2'000'000'000 : 0;
    });
    const Outcome outcome = process("in.mkv", "out");
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err, HasSubstr("--no-self-calibration"));
    EXPECT_EQ(process("in.mkv", "off", {"--no-self-calibration"}).exit_code, 0);
}

TEST_F(SelfCalibrationTest, NeedsACalibration) {
    make_recording(path("in.mkv"), 2, 64, 48);
    const Outcome outcome = process("in.mkv", "out", {"--self-calibrate"});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("has no calibration"));
    EXPECT_EQ(process("in.mkv", "out", {"--self-calibrate", "--no-self-calibration"}).exit_code, 2);
}

}  // namespace
}  // namespace disparityd::test
