// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/describe.h"

#include <cmath>

#include "capture/camera/camera_problem.h"
#include "capture/pixel_format.h"

namespace disparityd::tools {
namespace {

Json to_json(const calibration::CameraModel& camera) {
    return {
        {"fx", camera.fx}, {"fy", camera.fy}, {"cx", camera.cx}, {"cy", camera.cy}, {"distortion", camera.distortion}};
}

/// JSON has no infinity.
Json or_null(double value) {
    return std::isfinite(value) ? Json(value) : Json();
}

}  // namespace

Json to_json(const capture::CameraSurvey& survey) {
    const capture::UsbCamera& camera = survey.camera;
    Json json{{"model", camera.model()},
              {"name", camera.name},
              {"serial", camera.serial},
              {"node", camera.node},
              {"port", camera.port},
              {"vendor", camera.vendor},
              {"product", camera.product},
              {"firmware", capture::firmware_text(camera.firmware)},
              {"speed_mbit", camera.speed_mbit},
              {"usable", survey.problem.empty()},
              {"problem", survey.problem},
              {"notices", survey.notices},
              {"modes", Json::array()}};
    for (const capture::VideoMode& mode : survey.modes) {
        json["modes"].push_back({{"format", mode.format},
                                 {"width", mode.width},
                                 {"height", mode.height},
                                 {"frames_per_second", mode.rates}});
    }
    return json;
}

Json to_json(const capture::SourceInfo& source) {
    Json json{{"name", source.name},
              {"description", source.description},
              {"format", capture::to_string(source.format)},
              {"eye_width", source.eye_width},
              {"height", source.height},
              {"frames_per_second", nullptr},
              {"live", source.live},
              {"synthetic", source.synthetic},
              {"frames", nullptr},
              {"rectified", source.calibration && source.calibration->rectified},
              {"calibration", nullptr}};
    if (source.rate > 0) {
        json["frames_per_second"] = source.rate;
    }
    if (source.frame_count) {
        json["frames"] = *source.frame_count;
    }
    if (source.calibration && source.calibration->left.fx != 0) {
        json["calibration"] = to_json(*source.calibration);
    }
    return json;
}

Json to_json(const calibration::StereoCalibration& calibration) {
    return {{"origin", calibration.origin},      {"width", calibration.width},
            {"height", calibration.height},      {"rectified", calibration.rectified},
            {"left", to_json(calibration.left)}, {"right", to_json(calibration.right)},
            {"rotation", calibration.rotation},  {"translation_mm", calibration.translation}};
}

Json to_json(const calibration::Rectification& rectification) {
    return {{"width", rectification.width},
            {"height", rectification.height},
            {"f", rectification.f},
            {"cx", rectification.cx},
            {"cy", rectification.cy},
            {"baseline_mm", rectification.baseline_mm},
            {"disparity_offset", rectification.disparity_offset},
            {"unrectified", rectification.unrectified},
            {"calibration_id", hexadecimal(rectification.calibration_id)}};
}

Json to_json(const calibration::DepthRange& range) {
    Json json{{"nearest_m", or_null(range.nearest_m())},
              {"farthest_m", or_null(range.farthest_m())},
              {"step_px", range.step_px()},
              {"resolution", Json::array()},
              {"disparities_for", Json::array()}};
    for (const double distance : calibration::DepthRange::told_at_m) {
        json["resolution"].push_back({{"at_m", distance},
                                      {"step_m", or_null(range.error_m(distance, range.step_px()))},
                                      {"error_of_1px_m", or_null(range.error_m(distance, 1))}});
    }
    for (const double wanted : calibration::DepthRange::wanted_m) {
        const auto needed = range.disparities_for(wanted);
        json["disparities_for"].push_back({{"nearest_m", wanted}, {"disparities", needed ? Json(*needed) : Json()}});
    }
    return json;
}

Json to_json(const MatchOptions& options) {
    Json json{{"method", disparityd::to_string(options.method)},
              {"d_min", options.range.first},
              {"disparities", options.range.count}};
    if (options.method != Method::sad) {
        json["cost"] = disparityd::to_string(options.cost);
    }
    if (options.method == Method::sgm) {
        json["paths"] = options.sgm.paths;
        json["p1"] = options.sgm.p1;
        json["p2"] = options.sgm.p2;
        json["adaptive_p2"] = options.sgm.adaptive_p2;
        json["p2_slope"] = options.sgm.p2_slope;
        json["p2_min"] = options.sgm.p2_min;
        json["calibrated_confidence"] = options.sgm.calibrated_confidence;
    }
    json.update({{"subpixel", options.post.subpixel},
                 {"local_extrema", options.post.local_extrema},
                 {"uniqueness", options.post.uniqueness},
                 {"left_right_check", options.post.left_right_check},
                 {"median", options.post.median},
                 {"speckle_size", options.post.speckle_size},
                 {"speckle_step", options.post.speckle_step},
                 {"min_texture", options.post.min_texture},
                 {"interpolate", options.post.interpolate},
                 {"guided_median", options.post.guided_median}});
    return json;
}

Json to_json(const ScanOptions& options) {
    return {{"sectors", options.sectors},
            {"from_deg", options.from_deg},
            {"to_deg", options.to_deg},
            {"camera_height_m", options.camera_height_m},
            {"pitch_deg", options.pitch_deg},
            {"roll_deg", options.roll_deg},
            {"yaw_deg", options.yaw_deg},
            {"camera_ahead_m", options.camera_ahead_m},
            {"camera_left_m", options.camera_left_m},
            {"ground", to_string(options.ground)},
            {"imu_axes", options.imu_axes},
            {"low_m", options.low_m},
            {"high_m", options.high_m},
            {"min_m", options.min_m},
            {"max_m", options.max_m},
            {"object_m", options.object_m},
            {"max_error_m", options.max_error_m},
            {"min_confidence", options.min_confidence},
            {"subpixel_error_px", options.subpixel_error_px}};
}

}  // namespace disparityd::tools
