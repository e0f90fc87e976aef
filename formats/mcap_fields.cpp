// SPDX-License-Identifier: Apache-2.0
#include "formats/mcap_fields.h"

#include <stdexcept>
#include <utility>

#include "base/little_endian.h"

namespace disparityd::formats {

std::uint64_t McapFields::number(std::size_t size) {
    return base::get_little_endian(bytes(size).data(), size);
}

std::string_view McapFields::text() {
    const auto raw = bytes(u32());
    return {reinterpret_cast<const char*>(raw.data()), raw.size()};
}

std::span<const std::uint8_t> McapFields::bytes(std::uint64_t size) {
    if (size > rest_.size()) {
        throw std::runtime_error("a record is too short: " + std::to_string(size) + " bytes are expected, " +
                                 std::to_string(rest_.size()) + " are left");
    }
    const auto taken = rest_.first(static_cast<std::size_t>(size));
    rest_ = rest_.subspan(taken.size());
    return taken;
}

McapMessage mcap_message(std::span<const std::uint8_t> content) {
    McapFields fields(content);
    McapMessage message;
    message.channel = fields.u16();
    message.sequence = fields.u32();
    message.log_ns = fields.u64();
    message.publish_ns = fields.u64();
    message.data = fields.rest();
    return message;
}

bool McapDefinitions::take(McapOpcode opcode, std::span<const std::uint8_t> content) {
    switch (opcode) {
        case McapOpcode::schema: add_schema(content); return true;
        case McapOpcode::channel: add_channel(content); return true;
        default: return false;
    }
}

/// Files repeat their definitions.
template <typename Definition>
void McapDefinitions::add(std::map<std::uint16_t, Definition>& known, std::uint16_t id, Definition definition,
                          std::size_t bytes, const char* kind) {
    constexpr std::size_t most = std::size_t{16} << 20U;
    if (const auto before = known.find(id); before != known.end()) {
        if (before->second != definition) {
            throw std::runtime_error(std::string(kind) + ' ' + std::to_string(id) +
                                     " is there twice, with different contents");
        }
        return;
    }
    bytes_ += bytes;
    if (bytes_ > most) {
        throw std::runtime_error("schemas and channels have more than 16 MiB together");
    }
    known.emplace(id, std::move(definition));
}

void McapDefinitions::add_schema(std::span<const std::uint8_t> content) {
    McapFields fields(content);
    const std::uint16_t id = fields.u16();
    McapSchema schema;
    schema.name = fields.text();
    schema.encoding = fields.text();
    schema.text = std::make_shared<const std::string>(fields.text());
    if (id == 0) {
        throw std::runtime_error("a schema has the number 0, which means none");
    }
    add(schemas_, id, std::move(schema), content.size(), "schema");
}

void McapDefinitions::add_channel(std::span<const std::uint8_t> content) {
    McapFields fields(content);
    const std::uint16_t id = fields.u16();
    McapChannel channel;
    channel.schema = fields.u16();
    channel.topic = fields.text();
    channel.message_encoding = fields.text();
    fields.text();  // what the writer notes of the channel: of no use here
    if (channel.schema != 0 && !schemas_.contains(channel.schema)) {
        throw std::runtime_error("channel " + std::to_string(id) + " has the schema " + std::to_string(channel.schema) +
                                 ", which is not there");
    }
    add(channels_, id, std::move(channel), content.size(), "channel");
}

}  // namespace disparityd::formats
