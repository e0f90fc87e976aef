// SPDX-License-Identifier: Apache-2.0
#include "calibration/online/correction_file.h"

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/scene/scene_camera.h"
#include "tests/temporary_folder.h"

namespace disparityd::calibration {
namespace {

using testing::HasSubstr;

class CorrectionFile : public testing::Test {
protected:
    void SetUp() override { calibration_ = capture::scene_calibration(672, 376); }

    std::string refusal(const std::string& text) const {
        try {
            read_correction(folder_.write("c.txt", text), calibration_);
        } catch (const std::invalid_argument& error) {
            return error.what();
        }
        return "(accepted)";
    }

    std::string path() const { return correction_path(folder_.path(), serial_, 672, 376, calibration_); }

    const disparityd::test::TemporaryFolder folder_;
    std::string serial_;
    StereoCalibration calibration_;
};

TEST_F(CorrectionFile, ComesBackAsItWas) {
    serial_ = "SN12/../3";
    const std::string path = this->path();
    EXPECT_EQ(path, folder_.path() + "/self-calibration-SN12____3-672x376.txt");
    EXPECT_FALSE(read_correction(path, calibration_));
    const CalibrationCorrection correction{-1'817'963, 0, 403'723, -12};
    write_correction(path, calibration_, {1, 2, 3, 4});
    write_correction(path, calibration_, correction);
    EXPECT_EQ(read_correction(path, calibration_), correction);
    EXPECT_FALSE(std::filesystem::exists(path + ".new"));
}

TEST_F(CorrectionFile, OfAnotherCalibrationIsNotUsed) {
    const std::string path = this->path();
    write_correction(path, calibration_, {1, 2, 3, 4});
    StereoCalibration other = calibration_;
    other.left.fx += 1e-6;
    EXPECT_FALSE(read_correction(path, other));
    calibration_ = other;
    EXPECT_NE(this->path(), path);
}

TEST_F(CorrectionFile, DamagedOnesAreRefused) {
    const std::string path = this->path();
    write_correction(path, calibration_, {1, 2, 3, 4});
    std::ifstream file(path);
    const std::string good((std::istreambuf_iterator<char>(file)), {});
    EXPECT_EQ(refusal(good), "(accepted)");
    EXPECT_THAT(refusal(""), HasSubstr("begin with"));
    EXPECT_THAT(refusal("disparityd-correction 1\n"), HasSubstr("which calibration"));
    for (const char* bad : {"", "1.5", "99999999999", "x", "2000000000", "-60000000"}) {
        std::string text = good;
        text.replace(text.find("roll_nrad = 3"), 13, std::string("roll_nrad = ") + bad);
        EXPECT_THAT(refusal(text), HasSubstr("delete the file")) << bad;
    }
    for (std::size_t length = 0; length + 1 < good.size(); ++length) {
        EXPECT_NE(refusal(good.substr(0, length)), "(accepted)") << length;
    }
}

TEST_F(CorrectionFile, WhereNothingCanBeWrittenItSaysSo) {
    EXPECT_THROW(write_correction(folder_.file("none/c.txt"), calibration_, {}), std::runtime_error);
}

}  // namespace
}  // namespace disparityd::calibration
