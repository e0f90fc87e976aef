// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/http/server_settings.h"

#include <stdexcept>

namespace disparityd::web {

std::string fit_to_descriptors(ServerSettings& settings, std::size_t descriptors) {
    /// For the port, threads, the daemon's sockets and shared memory, and requests to the daemon.
    constexpr std::size_t own = 32;
    constexpr std::size_t least_connections = 8;
    const auto wanted = static_cast<std::size_t>(settings.max_connections);
    if (descriptors >= wanted + own) {
        return {};
    }
    const std::string found = "this process may open " + std::to_string(descriptors) +
                              " files, needed: " + std::to_string(wanted + own) + " for --max-connections " +
                              std::to_string(wanted);
    const std::string advice = "; raise the limit (ulimit -Hn, LimitNOFILE= of the unit) or lower --max-connections";
    if (descriptors < least_connections + own) {
        throw std::runtime_error(found + advice);
    }
    settings.max_connections = static_cast<int>(descriptors - own);
    return found + "; only " + std::to_string(settings.max_connections) + " connections are served" + advice;
}

}  // namespace disparityd::web
