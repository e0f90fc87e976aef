// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "bridges/web/metrics/web_counters.h"
#include "proto/disparity.pb.h"

namespace disparityd::web {

/// The type of the text, for the HTTP header Content-Type.
inline constexpr const char* prometheus_content_type = "text/plain; version=0.0.4; charset=utf-8";

/// Returns the metrics of docs/monitoring.md in Prometheus' text format 0.0.4. `status` is the daemon's newest, null
/// while the daemon is away: then disparityd_up is 0 and only the server's own metrics follow. What the status does not
/// have, such as a camera, has no metrics. A pure function: any thread; throws std::bad_alloc only.
///
/// Labels hold what the daemon chooses from short lists, and names of the camera and the configuration in use. Clients
/// of the daemon appear only as sums: they choose their names, and each new name would stay in Prometheus as a series.
std::string prometheus_text(const v1::Status* status, const WebCounters& web);

/// A daemon of several.
struct NamedStatus {
    std::string name;
    const v1::Status* status = nullptr;  ///< null while the daemon is away
};

/// The same of several daemons. Each sample of a daemon has the label "camera" with its name, where that is not "".
std::string prometheus_text(std::span<const NamedStatus> daemons, const WebCounters& web);

}  // namespace disparityd::web
