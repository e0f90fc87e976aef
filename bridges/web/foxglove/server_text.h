// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/web/foxglove/channels.h"

/// The texts of the server. They are JSON; bytes from outside that are not UTF-8 are replaced.
namespace disparityd::foxglove {

/// What the server tells of itself.
struct ServerFacts {
    std::string name;             ///< "disparityd"
    std::string version;          ///< "1.2.3"
    std::string session_id = {};  ///< the same for all connections of one server, another one after its restart
};

enum class Level { info = 0, warning = 1, error = 2 };

std::string server_info_text(const ServerFacts& facts);
std::string status_text(Level level, std::string_view message);
std::string advertise_text(std::span<const ChannelFacts> channels);
std::string unadvertise_text(std::span<const Channel> channels);

}  // namespace disparityd::foxglove
