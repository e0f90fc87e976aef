// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "kernels/pair_matcher.h"
#include "obstacles/obstacle_scanner.h"
#include "tests/kernels/support.h"

// Step 10 of docs/algorithm.md: what shows no texture is unknown, whatever the range and the disparity offset are.
namespace disparityd::test {
namespace {

constexpr int width = 320;
constexpr int height = 240;
constexpr int pixels = width * height;

/// Settings that users choose by one word.
struct Settings {
    const char* name;
    MatchOptions (*options)(DisparityRange range);
};

// What ctest lists; found by GoogleTest.
void PrintTo(const Settings& settings, std::ostream* out) {
    *out << settings.name;
}

const std::vector<Settings>& all_settings() {
    static const std::vector<Settings> all = {
        {"obstacles", [](DisparityRange range) { return preset_options(Preset::obstacles, range); }},
        {"dense", [](DisparityRange range) { return preset_options(Preset::dense, range); }},
        {"paper", [](DisparityRange range) { return preset_options(Preset::paper, range); }},
        {"census", [](DisparityRange range) { return default_options(Method::census, range); }},
        {"sad", [](DisparityRange range) { return default_options(Method::sad, range); }}};
    return all;
}

/// What both eyes see, without noise: a function of the place in the image, 0 to 1 in both directions.
struct View {
    const char* name;
    double (*brightness)(double x, double y);
};

constexpr View views[] = {{"black", [](double, double) { return 0.0; }},
                          {"white", [](double, double) { return 255.0; }},
                          {"grey", [](double, double) { return 128.0; }},
                          {"ramp", [](double x, double) { return 60 + 120 * x; }},
                          {"vignetting", [](double x, double y) {
                               const double away = std::hypot(x - 0.5, y - 0.5);
                               return 180 / ((1 + away * away) * (1 + away * away));
                           }}};

/// One eye's picture of a view.
class Eyes {
public:
    Image<std::uint8_t> picture(const View& view, double noise, bool hot_pixel, bool jpeg) {
        std::normal_distribution<double> distribution(0, std::max(noise, 1e-9));
        cv::Mat image(height, width, CV_8U);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const double value = view.brightness((x + 0.5) / width, (y + 0.5) / height) + distribution(random_);
                image.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(std::clamp(std::round(value), 0.0, 255.0));
            }
        }
        if (hot_pixel) {
            auto& value = image.at<std::uint8_t>(height / 3, width / 3);
            value = value < 128 ? 255 : 0;
        }
        if (jpeg) {
            std::vector<std::uint8_t> file;
            cv::imencode(".jpg", image, file, {cv::IMWRITE_JPEG_QUALITY, 80});
            image = cv::imdecode(file, cv::IMREAD_GRAYSCALE);
        }
        Image<std::uint8_t> out(width, height);
        for (int y = 0; y < height; ++y) {
            std::copy_n(image.ptr(y), width, out.plane().row(y));
        }
        return out;
    }

private:
    std::mt19937 random_{11};  // each eye has noise of its own
};

struct Found {
    int kept;
    int filled;
    Image<std::int16_t> disparity{width, height};
    Image<std::uint8_t> confidence{width, height};
};

Found match(const MatchOptions& options, const Image<std::uint8_t>& left, const Image<std::uint8_t>& right) {
    Found found{};
    Serial serial;
    PairMatcher(width, height, options, "cpu")
        .match(left.plane(), right.plane(), {found.disparity.plane(), found.confidence.plane(), {}, {}}, serial);
    const auto& sure = found.confidence.pixels();
    found.kept = static_cast<int>(std::count_if(sure.begin(), sure.end(), [](std::uint8_t c) { return c > 0; }));
    const std::int16_t rejected = invalid_disparity(options.range);
    const auto& all = found.disparity.pixels();
    found.filled = static_cast<int>(std::count_if(all.begin(), all.end(), [=](auto d) { return d != rejected; }));
    return found;
}

/// Sectors that are not unknown, for a disparity offset in px.
int sectors_known(const Found& found, int offset) {
    ScanOptions options;
    options.sectors = 31;
    options.camera_height_m = 0.3;
    ObstacleScanner scanner(width, height, options, fastest_frame_steps());
    Scan scan = scanner.empty_scan();
    const scan::Camera camera{width,       height,       250,
                              width / 2.0, height / 2.0, {std::lround(16 * 250 * 120.0), 16 * offset}};
    scanner.scan({found.disparity.plane(), found.confidence.plane()}, camera, scan);
    return static_cast<int>(std::count_if(scan.sectors.begin(), scan.sectors.end(), [](const ScanSector& sector) {
        return sector.state != SectorState::unknown;
    }));
}

class Textureless : public testing::TestWithParam<Settings> {
protected:
    void expect_unknown(const View& view, double noise, bool hot_pixel, bool jpeg) {
        const std::string what = std::string(view.name) + ", noise " + std::to_string(noise) +
                                 (hot_pixel ? ", hot pixel" : "") + (jpeg ? ", JPEG" : "");
        const auto left = eyes_.picture(view, noise, hot_pixel, jpeg);
        const auto right = eyes_.picture(view, noise, false, jpeg);  // a hot pixel is of one sensor
        for (const int d_min : {-16, 0, 8}) {
            SCOPED_TRACE(what + ", d_min " + std::to_string(d_min));
            const Found found = match(GetParam().options({d_min, 64}), left, right);
            EXPECT_LE(found.kept, pixels / 500);
            EXPECT_EQ(found.filled, found.kept) << "nothing is filled in from next to nothing";
            for (const int offset : {-15, 0, 15}) {
                EXPECT_EQ(sectors_known(found, offset), 0) << "offset " << offset;
            }
        }
    }

    Eyes eyes_;
};

TEST_P(Textureless, IsUnknownWhateverRangeAndOffsetAre) {
    for (const View& view : views) {
        for (const bool jpeg : {false, true}) {
            for (const double noise : {0.0, 0.3, 3.0}) {
                expect_unknown(view, noise, false, jpeg);
            }
            expect_unknown(view, 0, true, jpeg);
        }
    }
}

// The wall below it is measured: the test rejects what shows nothing, not the image around it. The white is a part of
// the wall here, so that the wall's own disparity is right in it.
TEST_P(Textureless, AnOverexposedHalfIsUnknownAndTheWallBelowItIsNot) {
    constexpr int d = 20;
    std::mt19937 random(3);
    Image<std::uint8_t> left(width, height, 255);
    Image<std::uint8_t> right(width, height, 255);
    for (int y = height / 2; y < height; ++y) {
        for (int x = 0; x < width + d; ++x) {
            const auto value = static_cast<std::uint8_t>(60 + random() % 120);
            if (x >= d) {
                right.at(x - d, y) = value;
            }
            if (x < width) {
                left.at(x, y) = value;
            }
        }
    }
    MatchOptions options = GetParam().options({0, 64});
    options.post.interpolate = false;
    const Found found = match(options, left, right);
    int invented = 0;
    int carried = 0;
    for (int y = 0; y < height / 2 - 16; ++y) {
        for (int x = 0; x < width; ++x) {
            const bool of_the_wall = std::abs(found.disparity.at(x, y) - 16 * d) <= 16;
            if (found.confidence.at(x, y) > 0) {
                ++(of_the_wall ? carried : invented);
            }
        }
    }
    EXPECT_LE(invented, pixels / 500);
    // Eight paths carry the wall's disparity far enough that the white is one region with the wall.
    if (GetParam().name != std::string("paper")) {
        EXPECT_LE(carried, pixels / 500);
    }
    EXPECT_GE(found.kept, pixels / 3);
}

INSTANTIATE_TEST_SUITE_P(Presets, Textureless, testing::ValuesIn(all_settings()),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace disparityd::test
