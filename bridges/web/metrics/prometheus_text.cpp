// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/metrics/prometheus_text.h"

#include <array>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <google/protobuf/message.h>

#include "bridges/web/metrics/exposition.h"

namespace disparityd::web {
namespace {

using namespace std::string_view_literals;

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

constexpr std::array daemon_states{"running"sv, "waiting"sv, "ended"sv, "stopping"sv};
constexpr std::array camera_states{"starting"sv,     "streaming"sv,      "absent"sv,       "stalled"sv,
                                   "busy"sv,         "no-permission"sv,  "old-firmware"sv, "usb2-link"sv,
                                   "mode-refused"sv, "no-calibration"sv, "changed"sv,      "failed"sv};
constexpr std::array sensor_states{"starting"sv, "streaming"sv, "absent"sv, "silent"sv, "no-permission"sv, "failed"sv};

/// The step of StepTotal that is not a part of a frame's way but all of it.
constexpr std::string_view whole_way = "total";

double gauge_of(const Message& message, const FieldDescriptor& field) {
    const Reflection& reflection = *message.GetReflection();
    if (field.is_repeated()) {
        return reflection.FieldSize(message, &field);
    }
    switch (field.cpp_type()) {
        case FieldDescriptor::CPPTYPE_BOOL: return reflection.GetBool(message, &field) ? 1 : 0;
        case FieldDescriptor::CPPTYPE_UINT32: return reflection.GetUInt32(message, &field);
        case FieldDescriptor::CPPTYPE_UINT64: return static_cast<double>(reflection.GetUInt64(message, &field));
        case FieldDescriptor::CPPTYPE_DOUBLE: return reflection.GetDouble(message, &field);
        case FieldDescriptor::CPPTYPE_STRING: return reflection.GetString(message, &field).empty() ? 0 : 1;
        default: throw std::logic_error("a field of this type is no metric: " + std::string(field.full_name()));
    }
}

void put_field(Exposition& out, const Message& message, const FieldDescriptor& field, const v1::FieldInfo& info) {
    if (info.metric().ends_with("_total")) {
        out.counter(info.metric(), info.help(), message.GetReflection()->GetUInt64(message, &field));
    } else {
        out.gauge(info.metric(), info.help(), gauge_of(message, field) * (info.factor() > 0 ? info.factor() : 1));
    }
}

/// Writes the metrics that disparity.proto names, of a message and of those that it contains. Counts of a camera and
/// of its sensors are those of the source in use: they start anew with a reload, which Prometheus takes for a reset.
void put_fields(Exposition& out, const Message& message) {
    for (int i = 0; i < message.GetDescriptor()->field_count(); ++i) {
        const FieldDescriptor& field = *message.GetDescriptor()->field(i);
        const v1::FieldInfo& info = field.options().GetExtension(v1::info);
        if (!info.metric().empty()) {
            put_field(out, message, field, info);
        } else if (field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE && !field.is_repeated()) {
            const Reflection& reflection = *message.GetReflection();
            if (reflection.HasField(message, &field)) {
                put_fields(out, reflection.GetMessage(message, &field, nullptr));
            }
        }
    }
}

void put_state(Exposition& out, const v1::Status& status) {
    out.info("disparityd_build_info", "Version of the daemon.", {{"version", status.server_version()}});
    out.states("disparityd_state", "State of the daemon, 1 for the one it is in.", daemon_states, status.state());
    out.info("disparityd_pipeline_info", "What the daemon computes, and where.",
             {{"source", status.source()}, {"method", status.method()}, {"backend", status.backend()}});
}

void put_histogram(Exposition& out, Exposition::Labels labels, const v1::Totals& totals, const v1::StepTotal& step) {
    constexpr double us_of_s = 1e6;
    constexpr double ns_of_s = 1e9;
    std::vector<double> bounds;
    for (const std::uint32_t bound : totals.bounds_us()) {
        bounds.push_back(bound / us_of_s);
    }
    const std::vector<std::uint64_t> up_to(step.up_to().begin(), step.up_to().end());
    out.histogram(labels, bounds, up_to, step.count(), static_cast<double>(step.sum_ns()) / ns_of_s);
}

void put_steps(Exposition& out, const v1::Totals& totals) {
    if (totals.steps_size() == 0) {
        return;  // the daemon prepares its first source
    }
    out.begin("disparityd_step_seconds", "histogram", "Time that a frame takes in each step of the pipeline.");
    for (const v1::StepTotal& step : totals.steps()) {
        if (step.name() != whole_way) {
            put_histogram(out, {{"step", step.name()}}, totals, step);
        }
    }
    for (const v1::StepTotal& step : totals.steps()) {
        if (step.name() == whole_way) {
            out.begin("disparityd_frame_seconds", "histogram",
                      "Time from the capture of a frame until it is published.");
            put_histogram(out, {}, totals, step);
        }
    }
}

void put_camera(Exposition& out, const v1::CameraStatus& camera) {
    out.states("disparityd_camera_state", "State of the live camera, 1 for the one it is in.", camera_states,
               camera.state());
    out.info("disparityd_camera_info", "The live camera, empty until one is found.",
             {{"model", camera.model()},
              {"serial", camera.serial()},
              {"firmware", camera.firmware()},
              {"port", camera.port()}});
}

void put_self_calibration(Exposition& out, const v1::SelfCalibration& calibration) {
    out.begin("disparityd_self_calibration_angle_degrees", "gauge",
              "Correction of the right camera, about its own axes.");
    out.sample({{"axis", "pitch"}}, calibration.pitch_degrees());
    out.sample({{"axis", "yaw"}}, calibration.yaw_degrees());
    out.sample({{"axis", "roll"}}, calibration.roll_degrees());
    // 0 says that nothing was measured: a sample would look like a perfect camera.
    if (calibration.error_before_px() > 0 || calibration.error_after_px() > 0) {
        out.begin("disparityd_self_calibration_error_pixels", "gauge",
                  "Median vertical distance of matches, by the factory's calibration and with the correction.");
        if (calibration.error_before_px() > 0) {
            out.sample({{"calibration", "factory"}}, calibration.error_before_px());
        }
        if (calibration.error_after_px() > 0) {
            out.sample({{"calibration", "corrected"}}, calibration.error_after_px());
        }
    }
}

void put_web(Exposition& out, const WebCounters& web) {
    out.gauge("disparity_web_clients", "Pages and viewers that this server sends frames to.",
              static_cast<double>(web.clients));
    out.counter("disparity_web_sent_bytes_total", "Bytes that this server has sent.", web.bytes_sent);
    out.counter("disparity_web_frames_sent_total", "Frames that this server has sent to all its clients together.",
                web.frames_sent);
    out.counter("disparity_web_frames_skipped_total",
                "Frames that this server has not sent to a client: too slow, or it wanted fewer.", web.frames_skipped);
    out.counter("disparity_web_requests_total", "HTTP requests to this server.", web.requests);
    out.counter("disparity_web_requests_refused_total", "HTTP requests that this server answered by an error.",
                web.refused);
}

}  // namespace

std::string prometheus_text(const v1::Status* status, const WebCounters& web) {
    Exposition out;
    out.gauge("disparityd_up", "Whether the daemon answers.", status != nullptr ? 1 : 0);
    if (status != nullptr) {
        put_state(out, *status);
        put_fields(out, *status);
        put_steps(out, status->totals());
        if (status->has_camera()) {
            put_camera(out, status->camera());
        }
        if (status->has_sensors()) {
            out.states("disparityd_sensors_state", "State of the camera's sensors, 1 for the one they are in.",
                       sensor_states, status->sensors().state());
        }
        if (status->has_self_calibration()) {
            put_self_calibration(out, status->self_calibration());
        }
    }
    put_web(out, web);
    return out.take();
}

}  // namespace disparityd::web
