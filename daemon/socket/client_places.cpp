// SPDX-License-Identifier: Apache-2.0
#include "daemon/socket/client_places.h"

#include <algorithm>

#include <fmt/format.h>

namespace disparityd::daemon {
namespace {

std::size_t allowed(std::size_t descriptors) {
    constexpr std::size_t others = ClientPlaces::reserved_descriptors + ClientPlaces::max_refused;
    return descriptors > others ? descriptors - others : 1;
}

}  // namespace

ClientPlaces::ClientPlaces(std::size_t wanted, std::size_t descriptors, bool serves_tcp, bool serves_unix)
    : wanted_(wanted),
      descriptors_(descriptors),
      all_(std::min(wanted, allowed(descriptors))),
      kept_(serves_tcp && serves_unix ? std::min(std::max<std::size_t>(1, all_ / 4), all_ - 1) : 0) {}

std::string ClientPlaces::refusal(bool local) const {
    if (!local && kept_ > 0) {
        return fmt::format(
            "the daemon serves {} clients over TCP already; {} more places are kept for the Unix socket ([socket] "
            "max_clients = {})",
            for_tcp(), kept_, wanted_);
    }
    return fmt::format("the daemon serves {} clients already, allowed: [socket] max_clients = {}{}", all_, wanted_,
                       all_ < wanted_ ? ", lowered for want of file descriptors" : "");
}

std::string ClientPlaces::notice() const {
    if (all_ == wanted_) {
        return {};
    }
    return fmt::format(
        "at most {} clients are served, not [socket] max_clients = {}: the process may have {} file descriptors open "
        "and needs {} for other things; raise the hard limit (LimitNOFILE= of the unit, ulimit -Hn)",
        all_, wanted_, descriptors_, reserved_descriptors + max_refused);
}

}  // namespace disparityd::daemon
