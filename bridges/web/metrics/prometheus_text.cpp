// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/metrics/prometheus_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <google/protobuf/message.h>

#include "proto/doubt.h"
#include "proto/text.h"

namespace disparityd::web {
namespace {

/// A label of a sample. The value may be any bytes.
struct Label {
    std::string_view name;
    std::string_view value;
};

/// Writes Prometheus' text format 0.0.4: metric by metric, each with its help and type before its samples, those of
/// several daemons together. Names and helps are the program's own and must be as the format wants them; values of
/// labels come from anywhere and are escaped.
class Exposition {
public:
    using Labels = std::initializer_list<Label>;

    /// The samples that follow are of this daemon: each has its name as a label; "" = there is only one, and no label.
    void set_camera(std::string_view name) { camera_ = name; }

    /// Begins a metric of several samples, or goes on with it.
    void begin(std::string_view name, std::string_view type, std::string_view help);
    void sample(Labels labels, double value);
    void sample(Labels labels, std::uint64_t value);

    /// Writes a metric of one sample without labels.
    void gauge(std::string_view name, std::string_view help, double value);
    void counter(std::string_view name, std::string_view help, std::uint64_t value);

    /// Writes a gauge that is 1, for what its labels say.
    void info(std::string_view name, std::string_view help, Labels labels);

    /// Writes a gauge for each of `states`, and for "other": 1 for the one that is `now`, else 0. A state that is not
    /// among them is the "other" one: a newer daemon may have it.
    void states(std::string_view name, std::string_view help, std::span<const std::string_view> states,
                std::string_view now);

    /// Writes one histogram of the metric that was begun: `up_to` counts what is at most as large as each of `bounds`,
    /// `count` all.
    void histogram(Labels labels, std::span<const double> bounds, std::span<const std::uint64_t> up_to,
                   std::uint64_t count, double sum);

    /// Returns all of it, in the order in which the metrics were begun.
    std::string text() const;

private:
    struct Metric {
        std::string name;
        std::string text;
    };

    void put_name(std::string_view suffix, Labels labels, const Label* last);
    void line(std::string_view suffix, Labels labels, const Label* last, std::string_view value);

    std::vector<Metric> metrics_;
    std::map<std::string, std::size_t, std::less<>> places_;  ///< in metrics_
    std::size_t now_ = 0;                                     ///< the place of the one that was begun
    std::string camera_;
};

std::string number(double value) {
    if (std::isnan(value)) {
        return "NaN";
    }
    if (std::isinf(value)) {
        return value > 0 ? "+Inf" : "-Inf";
    }
    return fmt::format("{}", value);
}

/// Returns a label's value as it stands between quotes: valid UTF-8 on one line.
std::string escaped(std::string_view value) {
    std::string out;
    for (const char byte : proto::to_valid_utf8(value)) {
        switch (byte) {
            case '\\': out += "\\\\"; break;
            case '"': out += "\\\""; break;
            case '\n': out += "\\n"; break;
            // Other control characters mean nothing in a name, and parsers differ about them.
            default: out += static_cast<unsigned char>(byte) < 0x20 || byte == 0x7f ? '?' : byte;
        }
    }
    return out;
}

void Exposition::begin(std::string_view name, std::string_view type, std::string_view help) {
    const auto [place, added] = places_.emplace(name, metrics_.size());
    now_ = place->second;
    if (added) {
        metrics_.push_back({place->first, fmt::format("# HELP {} {}\n# TYPE {} {}\n", name, help, name, type)});
    }
}

std::string Exposition::text() const {
    std::string text;
    for (const Metric& metric : metrics_) {
        text += metric.text;
    }
    return text;
}

void Exposition::sample(Labels labels, double value) {
    line("", labels, nullptr, number(value));
}

void Exposition::sample(Labels labels, std::uint64_t value) {
    line("", labels, nullptr, fmt::format("{}", value));
}

void Exposition::gauge(std::string_view name, std::string_view help, double value) {
    begin(name, "gauge", help);
    sample({}, value);
}

void Exposition::counter(std::string_view name, std::string_view help, std::uint64_t value) {
    begin(name, "counter", help);
    sample({}, value);
}

void Exposition::info(std::string_view name, std::string_view help, Labels labels) {
    begin(name, "gauge", help);
    sample(labels, std::uint64_t{1});
}

void Exposition::states(std::string_view name, std::string_view help, std::span<const std::string_view> states,
                        std::string_view now) {
    begin(name, "gauge", help);
    const auto put = [this](std::string_view state, bool is) { sample({{"state", state}}, std::uint64_t{is}); };
    for (const std::string_view state : states) {
        put(state, state == now);
    }
    put("other", std::find(states.begin(), states.end(), now) == states.end());
}

void Exposition::histogram(Labels labels, std::span<const double> bounds, std::span<const std::uint64_t> up_to,
                           std::uint64_t count, double sum) {
    for (std::size_t i = 0; i < std::min(bounds.size(), up_to.size()); ++i) {
        const std::string bound = number(bounds[i]);
        const Label last{"le", bound};
        line("_bucket", labels, &last, fmt::format("{}", up_to[i]));
    }
    const Label all{"le", "+Inf"};
    line("_bucket", labels, &all, fmt::format("{}", count));
    line("_sum", labels, nullptr, number(sum));
    line("_count", labels, nullptr, fmt::format("{}", count));
}

void Exposition::put_name(std::string_view suffix, Labels labels, const Label* last) {
    std::string& text = metrics_[now_].text;
    text += metrics_[now_].name;
    text += suffix;
    char before = '{';
    const auto put = [&](const Label& label) {
        text += fmt::format("{}{}=\"{}\"", before, label.name, escaped(label.value));
        before = ',';
    };
    if (!camera_.empty()) {
        put({"camera", camera_});
    }
    for (const Label& label : labels) {
        put(label);
    }
    if (last != nullptr) {
        put(*last);
    }
    text += before == ',' ? "}" : "";
}

void Exposition::line(std::string_view suffix, Labels labels, const Label* last, std::string_view value) {
    put_name(suffix, labels, last);
    std::string& text = metrics_[now_].text;
    text += ' ';
    text += value;
    text += '\n';
}

using namespace std::string_view_literals;

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

constexpr std::array daemon_states{"running"sv, "idle"sv, "waiting"sv, "ended"sv, "stopping"sv};
constexpr std::array camera_states{
    "starting"sv,  "streaming"sv,    "absent"sv,         "stalled"sv, "busy"sv,   "no-permission"sv, "old-firmware"sv,
    "usb2-link"sv, "mode-refused"sv, "no-calibration"sv, "changed"sv, "failed"sv, "unpaired"sv};
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

void put_doubts(Exposition& out, const v1::Trust& trust) {
    out.begin("disparityd_doubt", "gauge", "Why the newest frame can be trusted less, 1 for each reason that holds.");
    for (const proto::DoubtFacts& doubt : proto::doubts) {
        const auto& found = trust.doubts();
        out.sample({{"doubt", doubt.name}},
                   std::uint64_t{std::find(found.begin(), found.end(), doubt.name) != found.end()});
    }
}

void put_sector_doubts(Exposition& out, const v1::ScanStatus& scan) {
    out.begin("disparityd_scan_sectors_in_doubt", "gauge", "Sectors of the newest obstacle scan that have the doubt.");
    for (const proto::DoubtFacts& doubt : proto::doubts) {
        if ((doubt.bit & proto::sector_doubts) == 0) {
            continue;
        }
        std::uint64_t sectors = 0;
        for (const v1::SectorDoubt& found : scan.doubts()) {
            sectors += found.doubt() == doubt.name ? found.sectors() : 0;
        }
        out.sample({{"doubt", doubt.name}}, sectors);
    }
}

void put_daemon(Exposition& out, const v1::Status* status) {
    out.gauge("disparityd_up", "Whether the daemon answers.", status != nullptr ? 1 : 0);
    if (status == nullptr) {
        return;
    }
    put_state(out, *status);
    put_fields(out, *status);
    put_steps(out, status->totals());
    if (status->has_trust()) {
        put_doubts(out, status->trust());
    }
    if (status->has_scan()) {
        put_sector_doubts(out, status->scan());
    }
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
    const NamedStatus only{"", status};
    return prometheus_text(std::span(&only, 1), web);
}

std::string prometheus_text(std::span<const NamedStatus> daemons, const WebCounters& web) {
    Exposition out;
    for (const NamedStatus& daemon : daemons) {
        out.set_camera(daemon.name);
        put_daemon(out, daemon.status);
    }
    out.set_camera({});
    put_web(out, web);
    return out.text();
}

}  // namespace disparityd::web
