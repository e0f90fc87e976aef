// SPDX-License-Identifier: Apache-2.0
#include "formats/mcap_bag.h"

namespace disparityd::formats {

McapBag::McapBag(const std::string& path) : reader_(path) {
    for (const auto& [id, channel] : reader_.definitions().channels()) {
        connection_of(id);
    }
}

const BagConnection& McapBag::connection_of(std::uint16_t id) {
    const auto [place, is_new] = connections_.try_emplace(id);
    BagConnection& connection = place->second;
    if (is_new) {
        const auto& channel = reader_.definitions().channels().at(id);
        connection.topic = channel.topic;
        connection.encoding = channel.message_encoding;
        connection.messages = reader_.message_count(id);
        const auto& schemas = reader_.definitions().schemas();
        if (const auto schema = schemas.find(channel.schema); schema != schemas.end()) {
            connection.type = schema->second.name;
            connection.definition_encoding = schema->second.encoding;
            connection.definition = schema->second.text;
        }
    }
    return connection;
}

bool McapBag::next(Message& message) {
    McapMessage found;
    if (!reader_.next(found)) {
        return false;
    }
    message.connection = found.channel;
    message.topic = connection_of(found.channel).topic;
    message.log_ns = found.log_ns;
    message.data = found.data;
    return true;
}

}  // namespace disparityd::formats
