// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/describe.h"

#include <cmath>
#include <type_traits>
#include <variant>

#include "calibration/lens.h"
#include "capture/camera/camera_problem.h"
#include "capture/camera/stereo_advice.h"
#include "capture/pixel_format.h"
#include "kernels/match_fields.h"

namespace disparityd::tools {
namespace {

Json camera_json(const calibration::CameraModel& camera) {
    return {{"fx", camera.fx},
            {"fy", camera.fy},
            {"cx", camera.cx},
            {"cy", camera.cy},
            {"lens", camera.lens == calibration::LensModel::fisheye ? "fisheye" : "pinhole"},
            {"distortion", calibration::lens_coefficients(camera)}};
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
    const auto advice = capture::advise(survey);
    json["stereo"] = advice ? Json{{"reason", advice->reason}, {"uri", advice->uri}} : Json(nullptr);
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
    return {{"origin", calibration.origin},          {"width", calibration.width},
            {"height", calibration.height},          {"rectified", calibration.rectified},
            {"left", camera_json(calibration.left)}, {"right", camera_json(calibration.right)},
            {"rotation", calibration.rotation},      {"translation_mm", calibration.translation}};
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
    Json json{{"method", disparityd::to_string(options.method)}};
    if (options.method != Method::sad) {
        json["cost"] = disparityd::to_string(options.cost);
    }
    for (const MatchField& field : match_fields()) {
        if (!field.is_of_sgm() || options.method == Method::sgm) {
            const int value = field.value(options);
            json[std::string(field.name)] = field.is_switch() ? Json(value != 0) : Json(value);
        }
    }
    return json;
}

Json to_json(const ScanOptions& options) {
    Json json;
    for (const ScanField& field : scan_fields()) {
        json[std::string(field.name)] = std::visit(
            [&options](auto member) -> Json {
                if constexpr (std::is_same_v<decltype(member), GroundMode ScanOptions::*>) {
                    return to_string(options.*member);
                } else {
                    return options.*member;
                }
            },
            field.field);
    }
    return json;
}

}  // namespace disparityd::tools
