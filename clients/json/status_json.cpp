// SPDX-License-Identifier: Apache-2.0
#include "clients/json/status_json.h"

#include <cstdio>
#include <utility>

#include "proto/products.h"

namespace disparityd::json {
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
    Json products = Json::array();
    for (const int product : status.products()) {
        products.push_back(proto::product_name(static_cast<std::uint32_t>(product)));
    }
    Json json{{"server_version", status.server_version()},
              {"state", status.state()},
              {"detail", status.detail()},
              {"source", status.source()},
              {"synthetic", status.synthetic()},
              {"method", status.method()},
              {"backend", status.backend()},
              {"workers", status.workers()},
              {"geometry", to_json(status.geometry())},
              {"products", std::move(products)},
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

std::string hexadecimal(std::uint64_t id) {
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(id));
    return text;
}

std::string to_text(const Json& json, int indent) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace disparityd::json
