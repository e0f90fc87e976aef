// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <google/protobuf/message.h>
#include <nlohmann/json.hpp>

/// Converts what the daemon tells to JSON. disparityctl --json, the page and Foxglove's /status show the same.
/// proto/disparity.proto explains the fields.
namespace disparityd::json {

using Json = nlohmann::ordered_json;

/// Converts a message by a walk over its fields: their names and order are those of the .proto, all are there. An
/// absent message is null; a fixed64, which is an identity, is hexadecimal(); an enum's value is its name in lower
/// case, or the enum's name and the number where it has none here. Fields with FieldInfo.only_metrics are left out.
Json to_json(const google::protobuf::Message& message);

/// Returns the JSON schema of what to_json() makes of such a message.
Json schema_of(const google::protobuf::Descriptor& message);

/// What people are told of a field that has a FieldInfo.title.
struct Fact {
    std::string title;
    std::string text;  ///< the value with its unit, or "unknown"
    std::string help;
};

/// Returns those of a message and of the messages that it contains, in their order; empty texts are left out.
std::vector<Fact> facts_of(const google::protobuf::Message& message);

/// Returns 16 hexadecimal digits: JSON's numbers cannot hold 64 bits.
std::string hexadecimal(std::uint64_t id);

/// Returns the JSON as text. Bytes that are not UTF-8 are replaced.
std::string to_text(const Json& json, int indent);

}  // namespace disparityd::json
