// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace disparityd::ros2 {

/// How far other participants are looked for: ROS_AUTOMATIC_DISCOVERY_RANGE.
enum class DiscoveryRange {
    subnet,     ///< by multicast
    localhost,  ///< on this machine alone
    off,        ///< nowhere
    system      ///< as the configuration of Cyclone DDS says
};

/// Where a participant lives, as the environment variables of ROS 2 say.
struct Domain {
    std::uint32_t id = 0;                           ///< ROS_DOMAIN_ID
    DiscoveryRange range = DiscoveryRange::subnet;  ///< ROS_AUTOMATIC_DISCOVERY_RANGE
    bool loopback_alone = false;                    ///< ROS_LOCALHOST_ONLY=1: no other interface is used
    std::vector<std::string> peers = {};            ///< ROS_STATIC_PEERS: names or addresses
    std::string cyclone_configuration = {};         ///< CYCLONEDDS_URI, which goes before all of the above
};

/// Returns the value of an environment variable, "" where it is not set.
using Environment = std::function<std::string(const std::string& name)>;

/// Reads the variables. Throws std::invalid_argument with one line for a value that ROS 2 does not know.
Domain domain_of(const Environment& environment);

/// Returns the configuration for Cyclone DDS: the domain's, what large images need, and the user's own behind it.
std::string cyclone_configuration(const Domain& domain);

/// Returns one line when the system gives less memory for datagrams on their way than images need, with the commands
/// that help; else empty. Both are the limits net.core.rmem_max and net.core.wmem_max, in bytes; 0: unknown.
std::string small_buffers_text(std::uint64_t receive_most, std::uint64_t send_most);

}  // namespace disparityd::ros2
