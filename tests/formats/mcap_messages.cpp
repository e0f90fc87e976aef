// SPDX-License-Identifier: Apache-2.0
//
// Not a test: what other_mcap.cjs compares with another implementation of the format.
//   mcap_messages read FILE...     each message, as a line of JSON
//   mcap_messages write FOLDER     files of every combination of features, with their names on standard output, and
//                                  those that the product writes
#include <array>
#include <fstream>
#include <iostream>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "formats/mcap_file.h"
#include "formats/mcap_reader.h"
#include "formats/ros_message.h"
#include "tests/formats/mcap_writer.h"

namespace {

using namespace disparityd;
using Json = nlohmann::json;

std::string hexadecimal(std::span<const std::uint8_t> bytes) {
    constexpr std::string_view digits = "0123456789abcdef";
    std::string text;
    for (const std::uint8_t byte : bytes) {
        text += {digits[byte >> 4U], digits[byte & 15U]};
    }
    return text;
}

Json fields_of(const formats::McapSchema& schema, std::span<const std::uint8_t> data) {
    Json fields = Json::object();
    const formats::RosMessage message(formats::parse_ros_schema(schema.name, *schema.text), data);
    for (const auto& [path, value] : message.fields()) {
        std::visit(
            [&, &key = path](const auto& found) {
                if constexpr (std::is_same_v<std::decay_t<decltype(found)>, std::span<const std::uint8_t>>) {
                    fields[key] = hexadecimal(found);
                } else {
                    fields[key] = found;
                }
            },
            value);
    }
    return fields;
}

void read(const std::string& path) {
    formats::McapReader reader(path);
    const bool summary = reader.has_summary();
    formats::McapMessage message;
    Json messages = Json::array();
    while (reader.next(message)) {
        const formats::McapChannel& channel = reader.definitions().channels().at(message.channel);
        Json entry{{"topic", channel.topic},
                   {"encoding", channel.message_encoding},
                   {"sequence", message.sequence},
                   {"log", std::to_string(message.log_ns)},
                   {"publish", std::to_string(message.publish_ns)},
                   {"data", hexadecimal(message.data)}};
        if (channel.schema != 0) {
            const formats::McapSchema& schema = reader.definitions().schemas().at(channel.schema);
            entry["schema"] = {schema.name, schema.encoding, *schema.text};
            if (schema.encoding == "ros2msg") {
                entry["fields"] = fields_of(schema, message.data);
            }
        }
        messages.push_back(std::move(entry));
    }
    std::cout << Json{{"path", path}, {"summary", summary}, {"messages", messages}}.dump() << "\n";
}

void fill(test::McapWriter& writer, std::string_view contents) {
    if (contents == "NoData") {
        return;
    }
    if (contents == "OneAttachment") {
        writer.attachment("myFile", "\x01\x02\x03");
    } else if (contents == "OneMetadata") {
        writer.metadata("myMetadata", {{"foo", "bar"}});
    } else {
        const bool without = contents == "OneSchemalessMessage";
        const std::uint16_t schema = without ? 0 : writer.schema("Example", "c", "\x04\x05\x06");
        const std::uint16_t channel = writer.channel(schema, "example", "a");
        for (unsigned i = 0; i < (contents == "TenMessages" ? 10U : 1U); ++i) {
            writer.message(channel, 10 + i, 2 + i, std::string{'\x01', '\x02', static_cast<char>(i)});
        }
    }
}

/// Each bit of `choice` is a feature.
test::McapFeatures features_of(unsigned choice, const std::string& packing) {
    const auto has = [choice](unsigned bit) { return (choice >> bit & 1U) != 0; };
    test::McapFeatures features;
    features.packing = packing;
    features.chunk_bytes = 100;
    features.chunks = has(0);
    features.message_index = has(1);
    features.chunk_index = has(2);
    features.attachment_index = features.metadata_index = has(3);
    features.statistics = has(4);
    features.summary_offsets = has(5);
    features.repeated_schemas = has(6);
    features.repeated_channels = has(7);
    features.padding = has(8);
    features.checksums = has(9);
    return features;
}

void write(const std::string& folder) {
    constexpr unsigned choices = 1U << 10U;
    for (const std::string contents :
         {"NoData", "OneMessage", "TenMessages", "OneAttachment", "OneMetadata", "OneSchemalessMessage"}) {
        for (unsigned choice = 0; choice < choices; ++choice) {
            // Packing takes another program to undo: one file of each kind is enough.
            for (const std::string packing : {"", "zstd", "lz4"}) {
                if (!packing.empty() && (choice != choices - 1 || contents != "TenMessages")) {
                    continue;
                }
                const std::string name = contents + "-" + std::to_string(choice) + packing + ".mcap";
                test::McapWriter writer(features_of(choice, packing), "");
                fill(writer, contents);
                std::ofstream(folder + "/" + name, std::ios::binary) << writer.close();
                std::cout << Json{{"path", folder + "/" + name}, {"contents", contents}, {"choice", choice}}.dump()
                          << "\n";
            }
        }
    }
}

constexpr unsigned all_features = 0b10'1111'1111;  // no padding

/// The same contents by the product's writer, which knows neither attachments nor metadata.
void write_by_product(const std::string& folder) {
    for (const std::string contents : {"NoData", "OneMessage", "TenMessages", "OneSchemalessMessage"}) {
        const std::string path = folder + "/product-" + contents + ".mcap";
        formats::McapLayout layout;
        layout.profile.clear();
        layout.chunk_bytes = 100;
        formats::McapFile file(path, formats::McapFile::Existing::refused, layout);
        if (contents != "NoData") {
            const bool without = contents == "OneSchemalessMessage";
            const std::uint16_t schema = without ? 0 : file.add_schema("Example", "c", "\x04\x05\x06");
            const std::uint16_t channel = file.add_channel(schema, "example", "a");
            for (unsigned i = 0; i < (contents == "TenMessages" ? 10U : 1U); ++i) {
                const std::array<std::uint8_t, 3> data{1, 2, static_cast<std::uint8_t>(i)};
                file.write({channel, 10 + i, 2 + i, 2 + i, data});
            }
        }
        file.finish();
        std::cout << Json{{"path", path}, {"contents", contents}, {"choice", all_features}, {"product", true}}.dump()
                  << "\n";
    }
}

}  // namespace

int main(int count, char** arguments) {
    const std::string_view what = count > 1 ? arguments[1] : "";
    for (int i = 2; i < count; ++i) {
        if (what == "read") {
            read(arguments[i]);
        } else {
            write(arguments[i]);
            write_by_product(arguments[i]);
        }
    }
    return 0;
}
