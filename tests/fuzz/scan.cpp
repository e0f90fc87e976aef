// SPDX-License-Identifier: Apache-2.0
//
// Obstacle scans of any image, geometry and options. The same come from the reference and from each instruction set,
// and each keeps what docs/protocol.md promises.
#include <algorithm>
#include <cmath>
#include <vector>

#include "kernels/reference/steps.h"
#include "obstacles/obstacle_scanner.h"
#include "tests/fuzz/outcome.h"
#include "tests/fuzz/scan_vectors.h"

using namespace disparityd;

namespace {

/// Takes numbers from the input; zeros behind its end.
class Numbers {
public:
    Numbers(const std::uint8_t* data, std::size_t size) : at_(data), left_(size) {}

    int byte() {
        if (left_ == 0) {
            return 0;
        }
        --left_;
        return *at_++;
    }
    int word() {
        const int low = byte();
        return low + 256 * byte();
    }
    int within(int least, int most) { return least + word() % (most - least + 1); }
    double within(double least, double most) { return least + (most - least) * word() / 65535; }
    bool ended() const { return left_ == 0; }

private:
    const std::uint8_t* at_;
    std::size_t left_;
};

/// A byte says which option is meant, as long as it names one; the others have their defaults.
ScanOptions take_options(Numbers& numbers) {
    ScanOptions options;
    const auto fields = scan_fields();
    while (!numbers.ended()) {
        const auto i = static_cast<std::size_t>(numbers.byte());
        if (i >= fields.size()) {
            break;
        }
        const ScanField& field = fields[i];
        if (const auto* const whole = std::get_if<int ScanOptions::*>(&field.field)) {
            options.*(*whole) = numbers.within(static_cast<int>(field.min), static_cast<int>(field.max));
        } else if (const auto* const real = std::get_if<double ScanOptions::*>(&field.field)) {
            options.*(*real) = numbers.within(field.min, field.max);
        } else if (const auto* const flag = std::get_if<bool ScanOptions::*>(&field.field)) {
            options.*(*flag) = numbers.byte() % 2 == 1;
        } else if (std::holds_alternative<std::string ScanOptions::*>(field.field)) {
            options.imu_axes = numbers.byte() % 2 == 0 ? "ahead left up" : "right left up";
        } else {
            options.ground = static_cast<GroundMode>(numbers.byte() % 4);
        }
    }
    return options;
}

scan::Camera take_camera(Numbers& numbers) {
    scan::Camera camera;
    camera.width = numbers.within(1, 150);
    camera.height = numbers.within(1, 60);
    camera.f = numbers.within(0, 4000) / (numbers.byte() % 2 == 0 ? 1.0 : 100.0);
    camera.cx = numbers.within(-300, 500);
    camera.cy = numbers.within(-300, 500);
    camera.scale.k = std::int64_t{numbers.word()} << (numbers.byte() % 36);
    camera.scale.offset16 = numbers.within(-40000, 25535);
    return camera;
}

std::optional<CameraDirection> take_up(Numbers& numbers) {
    if (numbers.byte() % 4 == 0) {
        return std::nullopt;
    }
    const double right = numbers.within(-1.0, 1.0);
    const double ahead = numbers.within(-1.0, 1.0);
    return CameraDirection{right, -std::sqrt(std::max(1 - right * right - ahead * ahead, 0.0)), ahead};
}

struct Images {
    std::vector<std::int16_t> disparity;
    std::vector<std::uint8_t> confidence;
};

/// Rectangles of one disparity, or of a ramp, above each other, then pixels.
Images take_images(Numbers& numbers, int width, int height) {
    const auto size = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    Images images{std::vector<std::int16_t>(size), std::vector<std::uint8_t>(size)};
    for (int i = 0; i < 200 && !numbers.ended(); ++i) {
        const int left = numbers.byte() % width;
        const int top = numbers.byte() % height;
        const int right = std::min(left + 1 + numbers.byte(), width);
        const int bottom = std::min(top + 1 + numbers.byte(), height);
        const auto value = static_cast<std::int16_t>(numbers.word());
        const int slope = numbers.byte() - 128;
        const auto sure = static_cast<std::uint8_t>(numbers.byte());
        for (int y = top; y < bottom; ++y) {
            for (int x = left; x < right; ++x) {
                const auto at = static_cast<std::size_t>(y * width + x);
                images.disparity[at] = static_cast<std::int16_t>(std::clamp(value + slope * (y - top), -32768, 32767));
                images.confidence[at] = sure;
            }
        }
    }
    return images;
}

void expect_valid(const ScanSector& sector, const ScanOptions& options) {
    const double least = std::floor(1000 * options.min_m);
    const double most = 1000 * options.max_m + 1;
    fuzz::expect(sector.from_cdeg <= sector.to_cdeg, "a sector that ends before it begins");
    fuzz::expect(sector.free_mm <= most, "free beyond the largest distance");
    switch (sector.state) {
        case SectorState::unknown: fuzz::expect(sector.free_mm <= least + 1, "unknown, but free"); break;
        case SectorState::free: fuzz::expect(sector.free_mm >= least, "free, but not up to the least distance"); break;
        case SectorState::occupied:
            fuzz::expect(sector.distance_mm >= least && sector.distance_mm <= most, "a distance out of range");
            fuzz::expect(sector.free_mm <= sector.distance_mm, "free beyond the obstacle");
            fuzz::expect(sector.pixels > 0, "an obstacle without pixels");
            return;
        default: fuzz::fail("a state that there is not");
    }
    fuzz::expect(sector.distance_mm == 0 && sector.sigma_mm == 0 && sector.pixels == 0 && sector.confidence == 0,
                 "an obstacle where none is reported");
}

void expect_valid(const Scan& scan, const ScanOptions& options) {
    fuzz::expect(static_cast<int>(scan.sectors.size()) == options.sectors, "another number of sectors");
    for (const ScanSector& sector : scan.sectors) {
        expect_valid(sector, options);
    }
    fuzz::expect(std::isfinite(scan.ground.height_m) && std::isfinite(scan.ground.slope_ahead) &&
                     std::isfinite(scan.ground.slope_left),
                 "a ground that is no plane");
    fuzz::expect(scan.ground_source == GroundSource::configured ||
                     ((scan.ground_source == GroundSource::gravity) == (options.ground == GroundMode::gravity) &&
                      (scan.ground_source == GroundSource::autopilot) == (options.ground == GroundMode::autopilot)),
                 "a ground from elsewhere than configured");
}

/// Scans two frames, the second with what the first has left behind.
void expect_valid_scans(const scan::Pixels& pixels, const ScanOptions& options, const scan::Camera& camera,
                        const std::optional<CameraDirection>& up) {
    static const FrameSteps steps = [] {
        FrameSteps counting{};
        counting.scan_counts = reference::scan_counts;
        return counting;
    }();
    ObstacleScanner scanner(camera.width, camera.height, options, steps);
    Scan scan = scanner.empty_scan();
    for (int frame = 0; frame < 2; ++frame) {
        scanner.scan(pixels, camera, scan, up);
        expect_valid(scan, options);
    }
}

/// The counts are all of a scan that instruction sets compute.
void expect_same_counts(const scan::Pixels& pixels, const ScanOptions& options, const scan::Camera& camera) {
    scan::Geometry geometry(camera.width, camera.height, options);
    geometry.set(camera);
    scan::Band band(camera.width, camera.height);
    band.set(geometry, {});
    scan::Counts expected(geometry.sectors(), geometry.groups(), camera.width);
    const scan::CountTables tables = scan::count_tables(geometry, band);
    reference::scan_counts(pixels, tables, expected);
    static const std::vector<scan::CountPixels*> vectorised = fuzz::vectorised_scan_counts();
    for (scan::CountPixels* const count : vectorised) {
        scan::Counts counts(geometry.sectors(), geometry.groups(), camera.width);
        count(pixels, tables, counts);
        fuzz::expect(counts.seen == expected.seen, "an instruction set sees other pixels than the reference");
        fuzz::expect(counts.middle_bins == expected.middle_bins && counts.middle_counted == expected.middle_counted,
                     "an instruction set keeps other bins");
        for (int s = 0; s < geometry.sectors(); ++s) {
            fuzz::expect(
                std::equal(counts.obstacle_of(s), counts.obstacle_of(s) + scan::used_bins, expected.obstacle_of(s)),
                "an instruction set counts other obstacles than the reference");
        }
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Numbers numbers(data, size);
    const ScanOptions options = take_options(numbers);
    if (const std::string wrong = validate(options); !wrong.empty()) {
        fuzz::expect_line(wrong, "");
        return 0;
    }
    const scan::Camera camera = take_camera(numbers);
    const auto up = take_up(numbers);
    const Images images = take_images(numbers, camera.width, camera.height);
    const scan::Pixels pixels{{images.disparity.data(), camera.width, camera.height, camera.width},
                              {images.confidence.data(), camera.width, camera.height, camera.width}};
    expect_valid_scans(pixels, options, camera, up);
    if (camera.metric()) {
        expect_same_counts(pixels, options, camera);
    }
    return 0;
}
