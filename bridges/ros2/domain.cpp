// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros2/domain.h"

#include <charconv>
#include <map>
#include <stdexcept>

#include <unistd.h>

#include "base/words.h"

namespace disparityd::ros2 {
namespace {

/// Port numbers end there: 7400 + 250 id + 2 x participants.
constexpr std::uint32_t most_domain = 232;
/// A frame of HD720 in colour with its depths, and nearly one more.
constexpr std::uint64_t enough = 4 << 20;

[[noreturn]] void refuse_variable(const std::string& name, const std::string& value, const std::string& allowed) {
    throw std::invalid_argument(name + ": found \"" + value + "\", allowed: " + allowed);
}

std::uint32_t id_of(const std::string& text) {
    std::uint32_t id = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
    if (error != std::errc() || end != text.data() + text.size() || id > most_domain) {
        refuse_variable("ROS_DOMAIN_ID", text, "0 .. " + std::to_string(most_domain));
    }
    return id;
}

DiscoveryRange range_of(const std::string& text) {
    static const std::map<std::string, DiscoveryRange> ranges{{"SUBNET", DiscoveryRange::subnet},
                                                              {"LOCALHOST", DiscoveryRange::localhost},
                                                              {"OFF", DiscoveryRange::off},
                                                              {"SYSTEM_DEFAULT", DiscoveryRange::system}};
    const auto found = ranges.find(text);
    if (found == ranges.end()) {
        refuse_variable("ROS_AUTOMATIC_DISCOVERY_RANGE", text, "SUBNET, LOCALHOST, OFF, SYSTEM_DEFAULT");
    }
    return found->second;
}

bool is_localhost_only(const std::string& text) {
    if (text != "0" && text != "1") {
        refuse_variable("ROS_LOCALHOST_ONLY", text, "0, 1");
    }
    return text == "1";
}

std::vector<std::string> peers_of(const std::string& text) {
    constexpr const char* name_characters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.:-_[]%";
    std::vector<std::string> peers;
    for (const std::string_view peer : base::split(text, ';')) {
        if (peer.find_first_not_of(name_characters) != std::string_view::npos) {  // it becomes a part of XML
            refuse_variable("ROS_STATIC_PEERS", std::string(peer), "names and addresses with ; between them");
        }
        if (!peer.empty()) {
            peers.emplace_back(peer);
        }
    }
    return peers;
}

/// Peers that are looked for by their addresses, beside those that multicast finds.
std::string discovery_of(const Domain& domain) {
    if (domain.range == DiscoveryRange::off) {
        // Who has another tag is not heard.
        return "<ParticipantIndex>none</ParticipantIndex><Tag>ros_discovery_off_" + std::to_string(::getpid()) +
               "</Tag>";
    }
    std::string peers;
    if (domain.range == DiscoveryRange::localhost) {
        peers += "<Peer address=\"127.0.0.1\"/>";
    }
    for (const std::string& peer : domain.peers) {
        peers += "<Peer address=\"" + peer + "\"/>";
    }
    // A participant that is looked for by address has a port that can be guessed.
    return "<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>" +
           (peers.empty() ? "" : "<Peers>" + peers + "</Peers>");
}

}  // namespace

Domain domain_of(const Environment& environment) {
    Domain domain;
    if (const std::string text = environment("ROS_DOMAIN_ID"); !text.empty()) {
        domain.id = id_of(text);
    }
    if (const std::string text = environment("ROS_AUTOMATIC_DISCOVERY_RANGE"); !text.empty()) {
        domain.range = range_of(text);
    }
    if (const std::string text = environment("ROS_LOCALHOST_ONLY"); !text.empty() && is_localhost_only(text)) {
        domain.range = DiscoveryRange::localhost;
        domain.loopback_alone = true;
    }
    domain.peers = peers_of(environment("ROS_STATIC_PEERS"));
    domain.cyclone_configuration = environment("CYCLONEDDS_URI");
    return domain;
}

std::string cyclone_configuration(const Domain& domain) {
    const bool multicast = domain.range == DiscoveryRange::subnet || domain.range == DiscoveryRange::system;
    std::string general;
    if (domain.loopback_alone) {
        general += "<Interfaces><NetworkInterface address=\"127.0.0.1\"/></Interfaces>";
    }
    if (!multicast) {
        general += "<AllowMulticast>false</AllowMulticast>";
    }
    // An image is one datagram of some 64 KiB after the other, so that the system is called less often.
    general += "<MaxMessageSize>65000B</MaxMessageSize><FragmentSize>60000B</FragmentSize>";
    // A writer waits for readers above the high mark. The history is short, so it is never reached: a reader that has
    // stopped holds nobody.
    std::string internal =
        "<Watermarks><WhcLow>1MB</WhcLow><WhcHighInit>1GB</WhcHighInit><WhcHigh>1GB</WhcHigh><WhcAdaptive>false</"
        "WhcAdaptive></Watermarks>"
        "<SocketSendBufferSize min=\"default\" max=\"16MB\"/>";
    // Linux keeps a fifth of an image for who has not asked for more, and the rest is sent again: at once, and not
    // after the tenth of a second that small messages can wait.
    internal +=
        "<HeartbeatInterval min=\"2ms\" minsched=\"4ms\" max=\"1s\">5ms</HeartbeatInterval>"
        "<RetransmitMergingPeriod>0s</RetransmitMergingPeriod><MaxQueuedRexmitBytes>16MB</MaxQueuedRexmitBytes>";
    std::string xml = "<CycloneDDS><Domain><General>" + general + "</General>";
    if (domain.range != DiscoveryRange::system) {
        xml += "<Discovery>" + discovery_of(domain) + "</Discovery>";
    }
    xml += "<Internal>" + internal + "</Internal></Domain></CycloneDDS>";
    return domain.cyclone_configuration.empty() ? xml : xml + "," + domain.cyclone_configuration;
}

std::string small_buffers_text(std::uint64_t receive_most, std::uint64_t send_most) {
    std::string commands;
    const auto add = [&commands](const char* name, std::uint64_t most) {
        if (most != 0 && most < enough) {
            commands += std::string(commands.empty() ? "" : " ") + "net.core." + name + "=" + std::to_string(enough);
        }
    };
    add("rmem_max", receive_most);
    add("rmem_default", receive_most);  // Fast DDS takes it where nobody says otherwise
    add("wmem_max", send_most);
    return commands.empty()
               ? commands
               : "the system keeps less of images that are on their way than subscribers may need: on each "
                 "machine that subscribes, sysctl -w " +
                     commands + ", and again at each start in a file of /etc/sysctl.d";
}

}  // namespace disparityd::ros2
