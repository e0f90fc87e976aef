// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/foxglove/server_text.h"

#include "bridges/web/foxglove/message_schemas.h"
#include "clients/json/message_json.h"

namespace disparityd::foxglove {
namespace {

using json::Json;

std::string text_of(const Json& json) {
    return json::to_text(json, -1);
}

std::uint32_t id_of(Channel channel) {
    return static_cast<std::uint32_t>(channel);
}

Json json_of(const ChannelFacts& facts) {
    Json json{{"id", id_of(facts.channel)}, {"topic", facts.topic}};
    if (facts.message.empty()) {
        json.update({{"encoding", "json"},
                     {"schemaName", "disparityd.Status"},
                     {"schema", status_schema()},
                     {"schemaEncoding", "jsonschema"}});
    } else {
        json.update({{"encoding", "cdr"},
                     {"schemaName", schema_name(facts.message)},
                     {"schema", ros2msg(facts.message)},
                     {"schemaEncoding", "ros2msg"}});
    }
    return json;
}

}  // namespace

std::string server_info_text(const ServerFacts& facts) {
    return text_of({{"op", "serverInfo"},
                    {"name", facts.name},
                    {"capabilities", Json::array()},
                    {"supportedEncodings", Json::array()},
                    {"metadata", {{"version", facts.version}}},
                    {"sessionId", facts.session_id}});
}

std::string status_text(Level level, std::string_view message) {
    return text_of({{"op", "status"}, {"level", static_cast<int>(level)}, {"message", message}});
}

std::string advertise_text(std::span<const ChannelFacts> channels) {
    Json list = Json::array();
    for (const ChannelFacts& facts : channels) {
        list.push_back(json_of(facts));
    }
    return text_of({{"op", "advertise"}, {"channels", list}});
}

std::string unadvertise_text(std::span<const Channel> channels) {
    Json ids = Json::array();
    for (const Channel channel : channels) {
        ids.push_back(id_of(channel));
    }
    return text_of({{"op", "unadvertise"}, {"channelIds", ids}});
}

}  // namespace disparityd::foxglove
