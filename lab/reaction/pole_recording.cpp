// SPDX-License-Identifier: Apache-2.0
#include "lab/reaction/pole_recording.h"

#include <cmath>
#include <cstring>
#include <numbers>
#include <random>

#include "capture/recording/recording_writer.h"

namespace disparityd::reaction {
namespace {

constexpr double tolerance = 0.15;
constexpr double radius_m = 0.05;

capture::SourceInfo info_of(const PolePlan& plan) {
    capture::SourceInfo info;
    info.name = "poles";
    info.format = PixelFormat::grey8;
    info.eye_width = plan.camera.width;
    info.height = plan.camera.height;
    info.rate = plan.rate;
    info.synthetic = true;
    calibration::StereoCalibration calibration;
    calibration.width = plan.camera.width;
    calibration.height = plan.camera.height;
    calibration.rectified = true;
    calibration.origin = "poles";
    calibration.left = {
        plan.camera.f, plan.camera.f, (plan.camera.width - 1) / 2.0, (plan.camera.height - 1) / 2.0, {}};
    calibration.right = calibration.left;
    calibration.translation = {-1000 * plan.camera.baseline_m, 0, 0};
    info.calibration = calibration;
    return info;
}

/// Both eyes side by side.
std::vector<std::uint8_t> pixels_of(const eval::Course& course, const eval::CourseCamera& camera) {
    const eval::CourseView view = eval::draw(course, camera);
    const auto width = static_cast<std::size_t>(camera.width);
    std::vector<std::uint8_t> pixels(2 * view.left.size());
    for (std::size_t y = 0; y < static_cast<std::size_t>(camera.height); ++y) {
        std::memcpy(&pixels[2 * y * width], &view.left[y * width], width);
        std::memcpy(&pixels[(2 * y + 1) * width], &view.right[y * width], width);
    }
    return pixels;
}

}  // namespace

std::vector<Pole> write_pole_recording(const std::string& path, const PolePlan& plan,
                                       const std::function<void(int done)>& progress) {
    const capture::SourceInfo info = info_of(plan);
    capture::RecordingWriter writer(path, info);
    std::mt19937 random(1);
    const auto between = [&random](double least, double most) {
        return least + (most - least) * (static_cast<double>(random()) / 4294967296.0);
    };
    std::vector<Pole> poles;
    std::uint64_t sequence = 0;
    for (int round = 0; round < plan.rounds; ++round) {
        // Of one seed, the first course is an open floor.
        eval::Course course = eval::make_courses(static_cast<std::uint32_t>(round + 1), 1).front();
        const auto empty = pixels_of(course, plan.camera);
        const double ahead = between(1.5, 3);
        const double left = ahead * between(-0.5, 0.5);
        course.obstacles.push_back({eval::Obstacle::Shape::post,
                                    {ahead, left, 0.5},
                                    {radius_m, 0, 0.5},
                                    {eval::Surface::Kind::rough, between(70, 170), 60, 0.03}});
        const auto standing = pixels_of(course, plan.camera);
        poles.push_back({std::hypot(ahead, left) - radius_m, std::atan2(left, ahead) * 180 / std::numbers::pi});
        for (int i = 0; i < plan.frames_per_round(); ++i) {
            capture::RawFrame frame;
            frame.image = {i < plan.without ? empty.data() : standing.data(), info.format, info.eye_width, info.height,
                           2L * info.eye_width};
            frame.sequence = sequence;
            frame.monotonic_ns = std::llround(1e9 * static_cast<double>(sequence) / plan.rate);
            writer.write(frame);
            ++sequence;
        }
        progress(round + 1);
    }
    writer.close();
    return poles;
}

bool shows(const disparity::Scan& scan, const Pole& pole) {
    for (const disparity::ScanSector& sector : scan.sectors) {
        const double width = sector.to_deg - sector.from_deg;
        const bool there = pole.bearing_deg >= sector.from_deg - width && pole.bearing_deg <= sector.to_deg + width;
        if (there && sector.state == disparity::SectorState::occupied &&
            std::abs(sector.distance_m - pole.distance_m) <= tolerance * pole.distance_m) {
            return true;
        }
    }
    return false;
}

}  // namespace disparityd::reaction
