// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/http/server_settings.h"

#include <stdexcept>

#include "bridges/web/http/all_daemons.h"

namespace disparityd::web {

std::string fit_to_descriptors(ServerSettings& settings, std::size_t descriptors) {
    /// For the port, threads, a daemon's sockets and shared memory, and requests to it.
    constexpr std::size_t of_one_daemon = 32;
    constexpr std::size_t of_each_more = 8;
    const std::size_t own = of_one_daemon + (settings.all ? AllDaemons::most * of_each_more : 0);
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
