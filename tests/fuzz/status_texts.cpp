// SPDX-License-Identifier: Apache-2.0
//
// What is told of a daemon's status: JSON that another parser reads back with the same values, and lines for
// Prometheus.
#include <cmath>
#include <sstream>

#include "bridges/web/metrics/prometheus_text.h"
#include "clients/json/message_json.h"
#include "proto/disparity.pb.h"
#include "tests/fuzz/outcome.h"

using namespace disparityd;

namespace {

using Parsed = nlohmann::json;

/// JSON has no word for what is no number.
void expect_number(const Parsed& json, double value) {
    if (std::isfinite(value)) {
        fuzz::expect(json.is_number() && json.get<double>() == value, "JSON has another number");
    } else {
        fuzz::expect(json.is_null(), "JSON has a number for what is none");
    }
}

void expect_count(const Parsed& json, std::uint64_t value) {
    fuzz::expect(json.is_number_unsigned() && json.get<std::uint64_t>() == value, "JSON has another count");
}

/// Bytes that are not UTF-8 are replaced; all else stays.
void expect_text(const Parsed& json, const std::string& value) {
    fuzz::expect(json.is_string(), "JSON has no text");
    bool valid = true;
    try {
        static_cast<void>(Parsed(value).dump());
    } catch (const Parsed::type_error&) {
        valid = false;
    }
    fuzz::expect(!valid || json.get<std::string>() == value, "JSON has another text");
}

void expect_size(const Parsed& json, int size) {
    fuzz::expect(json.is_array() && json.size() == static_cast<std::size_t>(size), "JSON has another number of items");
}

void expect_same_geometry(const Parsed& json, const v1::Geometry& geometry) {
    expect_number(json["baseline_mm"], geometry.baseline_mm());
    fuzz::expect(json["d_min"] == geometry.d_min(), "JSON has another first disparity");
    fuzz::expect(std::stoull(json["calibration_id"].get<std::string>(), nullptr, 16) == geometry.calibration_id(),
                 "JSON has another calibration");
}

/// What a status may lack is null.
void expect_same_source(const Parsed& json, const v1::Status& status) {
    fuzz::expect(json["geometry"].is_null() != status.has_geometry(), "JSON and status differ about the geometry");
    if (status.has_geometry()) {
        expect_same_geometry(json["geometry"], status.geometry());
    }
    fuzz::expect(json["record"].is_null() != status.has_record(), "JSON and status differ about the recording");
    if (status.has_record()) {
        expect_count(json["record"]["bytes"], status.record().bytes());
        expect_text(json["record"]["path"], status.record().path());
    }
    fuzz::expect(json["camera"].is_null() != status.has_camera(), "JSON and status differ about the camera");
    if (status.has_camera()) {
        expect_text(json["camera"]["serial"], status.camera().serial());
        expect_number(json["camera"]["speed_mbit"], status.camera().speed_mbit());
        expect_count(json["camera"]["too_short"], status.camera().too_short());
    }
    fuzz::expect(json["sensors"].is_null() != status.has_sensors(), "JSON and status differ about the sensors");
    if (status.has_sensors()) {
        expect_number(json["sensors"]["drift_ppm"], status.sensors().drift_ppm());
        expect_text(json["sensors"]["detail"], status.sensors().detail());
    }
    fuzz::expect(json["self_calibration"].is_null() != status.has_self_calibration(),
                 "JSON and status differ about the self-calibration");
    if (status.has_self_calibration()) {
        expect_number(json["self_calibration"]["focal_ratio"], status.self_calibration().focal_ratio());
        expect_count(json["self_calibration"]["since_sequence"], status.self_calibration().since_sequence());
    }
}

void expect_same(const Parsed& json, const v1::Status& status) {
    expect_text(json["source"], status.source());
    expect_text(json["detail"], status.detail());
    expect_number(json["rate"], status.rate());
    expect_number(json["uptime_s"], status.uptime_s());
    expect_count(json["captured"], status.captured());
    expect_count(json["lost"], status.lost());
    expect_size(json["steps"], status.steps_size());
    for (int i = 0; i < status.steps_size(); ++i) {
        const Parsed& step = json["steps"][static_cast<std::size_t>(i)];
        expect_text(step["name"], status.steps(i).name());
        expect_number(step["p99_us"], status.steps(i).p99_us());
    }
    expect_size(json["clients"], status.clients_size());
    for (int i = 0; i < status.clients_size(); ++i) {
        const Parsed& client = json["clients"][static_cast<std::size_t>(i)];
        expect_text(client["name"], status.clients(i).name());
        expect_count(client["frames_skipped"], status.clients(i).frames_skipped());
    }
    expect_size(json["notices"], status.notices_size());
    expect_same_source(json, status);
}

/// Each line is a comment, or a name with labels, a blank and a number.
void expect_lines_of_prometheus(const std::string& text) {
    fuzz::expect(!text.empty() && text.back() == '\n', "the last line has no end");
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        fuzz::expect_line(line.substr(0, 500), "");
        if (line.front() == '#') {
            continue;
        }
        const std::size_t name = line.find_first_of("{ ");
        fuzz::expect(name != std::string::npos && name > 0, "a line without a name");
        const std::size_t blank = line.rfind(' ');
        fuzz::expect(line[name] == ' ' ? blank == name : line[blank - 1] == '}', "labels without an end");
        char* end = nullptr;
        std::strtod(line.c_str() + blank + 1, &end);
        fuzz::expect(end != line.c_str() + blank + 1 && *end == '\0', "a value that is no number");
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    v1::Status status;
    if (!status.ParseFromArray(data, static_cast<int>(size))) {
        return 0;
    }
    for (const int indent : {-1, 2}) {
        const Parsed json = Parsed::parse(json::to_text(json::to_json(status), indent), nullptr, false);
        fuzz::expect(json.is_object(), "what is told is no JSON");
        expect_same(json, status);
    }
    expect_lines_of_prometheus(web::prometheus_text(&status, {}));
    return 0;
}
