// SPDX-License-Identifier: Apache-2.0
//
// What docs/foxglove.md and the layout beside it say of channels is true.
#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "bridges/ros_messages/encode.h"
#include "bridges/web/foxglove/channels.h"

namespace disparityd::foxglove {
namespace {

using nlohmann::json;

std::string file(const std::string& name) {
    std::ifstream stream(std::string(DISPARITYD_DOCUMENTS) + "/" + name);
    return {std::istreambuf_iterator<char>(stream), {}};
}

std::set<std::string> topics() {
    std::set<std::string> list;
    for (const ChannelFacts& facts : all_channels()) {
        list.insert(std::string(facts.topic));
    }
    return list;
}

/// Adds the panels of a tree of panes.
void add_panels(const json& node, std::set<std::string>& panels) {
    if (node.is_string()) {
        EXPECT_TRUE(panels.insert(node).second) << node << " is there twice";
        return;
    }
    EXPECT_TRUE(node.at("direction") == "row" || node.at("direction") == "column");
    add_panels(node.at("first"), panels);
    add_panels(node.at("second"), panels);
}

TEST(FoxgloveDocuments, ThePageListsEachChannelWithItsMessage) {
    const std::string page = file("foxglove.md");
    for (const ChannelFacts& facts : all_channels()) {
        const std::size_t place = page.find("`" + std::string(facts.topic) + "`");
        ASSERT_NE(place, std::string::npos) << facts.topic;
        const std::string line = page.substr(place, page.find('\n', place) - place);
        const std::string_view message = ros::message_name(facts.channel);
        const std::string name(message.substr(message.find('/') + 1));
        EXPECT_NE(line.find(message.empty() ? "JSON" : name), std::string::npos) << facts.topic;
    }
}

TEST(FoxgloveDocuments, TheLayoutShowsTopicsThatThereAre) {
    const json layout = json::parse(file("foxglove-layout.json"));
    const std::set<std::string> known = topics();
    std::set<std::string> named;
    for (const auto& [id, panel] : layout.at("configById").items()) {
        const json image = panel.value("imageMode", json::object());
        for (const json& topic : {image.value("imageTopic", json()), image.value("calibrationTopic", json()),
                                  panel.value("topicPath", json())}) {
            if (topic.is_string()) {
                named.insert(topic);
            }
        }
        const json shown = panel.value("topics", json::object());
        for (const auto& [topic, settings] : shown.items()) {
            named.insert(topic);
        }
        for (const json& path : panel.value("paths", json::array())) {
            const std::string value = path.at("value");
            named.insert(value.substr(0, value.find('.')));
        }
    }
    EXPECT_GE(named.size(), 6U);
    for (const std::string& topic : named) {
        EXPECT_TRUE(known.contains(topic)) << topic;
    }
}

TEST(FoxgloveDocuments, TheLayoutPlacesThePanelsThatItConfigures) {
    const json layout = json::parse(file("foxglove-layout.json"));
    std::set<std::string> placed;
    add_panels(layout.at("layout"), placed);
    std::set<std::string> configured;
    for (const auto& [id, panel] : layout.at("configById").items()) {
        configured.insert(id);
        const std::string type = id.substr(0, id.find('!'));
        EXPECT_TRUE((std::set<std::string>{"Image", "3D", "Plot", "RawMessages"}.contains(type))) << id;
    }
    EXPECT_EQ(placed, configured);
}

}  // namespace
}  // namespace disparityd::foxglove
