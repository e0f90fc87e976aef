// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros_messages/diagnostic_message.h"

#include <utility>
#include <vector>

#include "bridges/ros_messages/message_header.h"

namespace disparityd::ros {
namespace {

/// diagnostic_msgs/msg/DiagnosticStatus
enum class Level : std::uint8_t { ok = 0, warn = 1, error = 2, stale = 3 };

using Values = std::vector<std::pair<std::string, std::string>>;

struct Diagnosis {
    Level level = Level::ok;
    std::string line;
};

Diagnosis diagnosis_of(const v1::Status& status) {
    const bool serves = status.state() == "running" || status.state() == "idle";
    if (!serves) {
        const Level level = status.state() == "waiting" || status.state() == "ended" ? Level::warn : Level::error;
        return {level, status.detail().empty() ? status.state() : status.detail()};
    }
    if (!status.trust().alarm().empty()) {
        return {Level::warn, status.trust().alarm()};
    }
    if (status.notices_size() > 0) {
        return {Level::warn, status.notices(0)};
    }
    return {Level::ok, status.detail().empty() ? status.state() : status.detail()};
}

Values values_of(const v1::Status& status) {
    Values values{{"state", status.state()},
                  {"source", status.source()},
                  {"method", status.method()},
                  {"backend", status.backend()},
                  {"rate", std::to_string(status.rate())},
                  {"published", std::to_string(status.published())},
                  {"dropped", std::to_string(status.dropped())},
                  {"lost", std::to_string(status.lost())},
                  {"measured ratio", std::to_string(status.measured().ratio())}};
    if (status.has_trust()) {
        values.emplace_back("trust ratio", std::to_string(status.trust().ratio()));
        for (const std::string& doubt : status.trust().doubts()) {
            values.emplace_back("doubt", doubt);
        }
    }
    for (const std::string& notice : status.notices()) {
        values.emplace_back("notice", notice);
    }
    return values;
}

std::string message(const Diagnosis& diagnosis, const std::string& name, const std::string& hardware,
                    const Values& values, std::int64_t realtime_ns) {
    CdrWriter cdr(1024);
    write_header(cdr, realtime_ns, "");
    cdr.length(1).u8(static_cast<std::uint8_t>(diagnosis.level)).text(name).text(diagnosis.line).text(hardware);
    cdr.length(values.size());
    for (const auto& [key, value] : values) {
        cdr.text(key).text(value);
    }
    return cdr.take();
}

}  // namespace

std::string diagnostic_message(const v1::Status& status, const std::string& name, std::int64_t realtime_ns) {
    const v1::CameraStatus& camera = status.camera();
    const std::string hardware = camera.model() + (camera.serial().empty() ? "" : " ") + camera.serial();
    return message(diagnosis_of(status), name, hardware, values_of(status), realtime_ns);
}

std::string stale_diagnostic(const std::string& why, const std::string& name, std::int64_t realtime_ns) {
    return message({Level::stale, why}, name, "", {}, realtime_ns);
}

std::string no_status_diagnostic(const std::string& why, const std::string& name, std::int64_t realtime_ns) {
    return message({Level::warn, "frames come, and the daemon tells no status: " + why}, name, "", {}, realtime_ns);
}

}  // namespace disparityd::ros
