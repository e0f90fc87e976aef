// SPDX-License-Identifier: Apache-2.0
#include "formats/mcap_bag.h"

namespace disparityd::formats {

std::map<std::uint32_t, BagConnection> McapBag::connections() const {
    std::map<std::uint32_t, BagConnection> connections;
    const auto& schemas = reader_.definitions().schemas();
    for (const auto& [id, channel] : reader_.definitions().channels()) {
        BagConnection& connection = connections[id];
        connection.topic = channel.topic;
        connection.encoding = channel.message_encoding;
        connection.messages = reader_.message_count(id);
        if (const auto schema = schemas.find(channel.schema); schema != schemas.end()) {
            connection.type = schema->second.name;
            connection.definition_encoding = schema->second.encoding;
            connection.definition = schema->second.text;
        }
    }
    return connections;
}

bool McapBag::next(Message& message) {
    McapMessage found;
    if (!reader_.next(found)) {
        return false;
    }
    message.connection = found.channel;
    message.topic = reader_.definitions().channels().at(found.channel).topic;
    message.log_ns = found.log_ns;
    message.data = found.data;
    return true;
}

}  // namespace disparityd::formats
