// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "formats/mcap_reader.h"
#include "formats/ros_message.h"

namespace disparityd::test {

/// A message of a file, with its fields. It lives until the next one is read.
struct McapRead {
    const std::string& topic;
    const std::string& type;  ///< "sensor_msgs/msg/Image"
    const formats::McapMessage& message;
    const formats::RosMessage& fields;
};

/// Reads all messages of a file that was ended well, in their order.
inline void read_mcap(const std::string& path, const std::function<void(const McapRead&)>& take) {
    formats::McapReader reader(path);
    EXPECT_TRUE(reader.has_summary());
    formats::McapMessage message;
    while (reader.next(message)) {
        const formats::McapChannel& channel = reader.definitions().channels().at(message.channel);
        const formats::McapSchema& schema = reader.definitions().schemas().at(channel.schema);
        const formats::RosMessage fields(formats::parse_ros_schema(schema.name, *schema.text), message.data);
        take({channel.topic, schema.name, message, fields});
    }
}

}  // namespace disparityd::test
