// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/describe.h"

#include <cstdio>

#include "capture/camera/camera_problem.h"
#include "capture/pixel_format.h"

namespace disparityd::tools {
namespace {

Json to_json(const v1::Geometry& geometry) {
    return {{"width", geometry.width()},
            {"height", geometry.height()},
            {"f", geometry.f()},
            {"cx", geometry.cx()},
            {"cy", geometry.cy()},
            {"baseline_mm", geometry.baseline_mm()},
            {"disparity_offset", geometry.disparity_offset()},
            {"d_min", geometry.d_min()},
            {"disparities", geometry.disparities()},
            {"invalid", geometry.invalid()},
            {"calibration_id", hexadecimal(geometry.calibration_id())}};
}

Json to_json(const v1::StepTime& step) {
    return {{"name", step.name()},     {"count", step.count()},   {"mean_us", step.mean_us()},
            {"p50_us", step.p50_us()}, {"p90_us", step.p90_us()}, {"p99_us", step.p99_us()},
            {"max_us", step.max_us()}};
}

Json to_json(const v1::ClientStatus& client) {
    return {{"name", client.name()},
            {"address", client.address()},
            {"frames_sent", client.frames_sent()},
            {"frames_skipped", client.frames_skipped()},
            {"bytes_sent", client.bytes_sent()},
            {"compressed_bytes", client.compressed_bytes()},
            {"compressor_us", client.compressor_us()},
            {"compressor_share", client.compressor_share()}};
}

Json to_json(const calibration::CameraModel& camera) {
    return {
        {"fx", camera.fx}, {"fy", camera.fy}, {"cx", camera.cx}, {"cy", camera.cy}, {"distortion", camera.distortion}};
}

template <typename List>
Json list(const List& items) {
    Json array = Json::array();
    for (const auto& item : items) {
        array.push_back(to_json(item));
    }
    return array;
}

}  // namespace

Json to_json(const v1::Status& status) {
    Json json{{"server_version", status.server_version()},
              {"state", status.state()},
              {"detail", status.detail()},
              {"source", status.source()},
              {"synthetic", status.synthetic()},
              {"method", status.method()},
              {"backend", status.backend()},
              {"workers", status.workers()},
              {"geometry", to_json(status.geometry())},
              {"frames_per_second", status.rate()},
              {"captured", status.captured()},
              {"published", status.published()},
              {"dropped", status.dropped()},
              {"lost_before", status.lost_before()},
              {"corrupt", status.corrupt()},
              {"uptime_s", status.uptime_s()},
              {"steps", list(status.steps())},
              {"clients", list(status.clients())},
              {"record", to_json(status.record())},
              {"self_calibration", nullptr}};
    if (status.has_self_calibration()) {
        json["self_calibration"] = to_json(status.self_calibration());
    }
    if (status.has_camera()) {
        json["camera"] = to_json(status.camera());
    }
    if (status.has_sensors()) {
        json["sensors"] = to_json(status.sensors());
    }
    json["notices"] = Json::array();
    for (const std::string& notice : status.notices()) {
        json["notices"].push_back(notice);
    }
    return json;
}

Json to_json(const v1::SelfCalibration& status) {
    return {{"estimating", status.estimating()},
            {"corrected", status.corrected()},
            {"since_sequence", status.since_sequence()},
            {"pitch_degrees", status.pitch_degrees()},
            {"yaw_degrees", status.yaw_degrees()},
            {"roll_degrees", status.roll_degrees()},
            {"focal_ratio", status.focal_ratio()},
            {"vertical_error_before_px", status.error_before_px()},
            {"vertical_error_after_px", status.error_after_px()},
            {"frames", status.frames()},
            {"matches", status.matches()},
            {"detail", status.detail()}};
}

Json to_json(const v1::RecordStatus& status) {
    return {{"active", status.active()},  {"path", status.path()},
            {"frames", status.frames()},  {"lost", status.lost()},
            {"bytes", status.bytes()},    {"seconds", status.seconds()},
            {"error", status.error()},    {"source_lost", status.source_lost()},
            {"removed", status.removed()}};
}

Json to_json(const v1::CameraStatus& camera) {
    return {{"state", camera.state()},
            {"model", camera.model()},
            {"serial", camera.serial()},
            {"node", camera.node()},
            {"port", camera.port()},
            {"firmware", camera.firmware()},
            {"speed_mbit", camera.speed_mbit()},
            {"frames_per_second", camera.rate()},
            {"arrivals", camera.arrivals()},
            {"restarts", camera.restarts()},
            {"reopens", camera.reopens()},
            {"resets", camera.resets()},
            {"damaged", camera.damaged()},
            {"too_short", camera.too_short()}};
}

Json to_json(const v1::SensorStatus& sensors) {
    return {{"state", sensors.state()},
            {"detail", sensors.detail()},
            {"node", sensors.node()},
            {"samples", sensors.samples()},
            {"lost", sensors.lost()},
            {"refused", sensors.refused()},
            {"clock_jumps", sensors.clock_jumps()},
            {"drift_ppm", sensors.drift_ppm()}};
}

Json to_json(const v1::CameraControls& controls) {
    Json list = Json::array();
    for (const v1::CameraControl& control : controls.controls()) {
        list.push_back({{"name", control.name()},
                        {"value", control.value()},
                        {"least", control.least()},
                        {"most", control.most()},
                        {"usual", control.usual()}});
    }
    return list;
}

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

std::string hexadecimal(std::uint64_t id) {
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(id));
    return text;
}

std::string to_text(const Json& json, int indent) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace disparityd::tools
