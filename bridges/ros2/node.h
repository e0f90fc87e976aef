// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <dds/dds.h>

#include "bridges/ros2/domain.h"

namespace disparityd::ros2 {

/// How messages of a topic are kept and sent.
struct Quality {
    bool reliable = true;          ///< what got lost is sent again; subscribers that ask for best effort match, too
    bool transient_local = false;  ///< a subscriber that comes later gets the last ones
    std::int32_t depth = 5;        ///< how many are kept; 1 or more
};

/// What publishes one topic. Its node outlives it. Any thread may call.
class Publisher {
public:
    Publisher(dds_entity_t writer, std::string topic) : writer_(writer), topic_(std::move(topic)) {}

    /// Returns how many subscribers it has now.
    std::uint32_t readers() const;

    /// Sends a message: CDR of the topic's type, with its header. It waits for none of the subscribers. Returns false
    /// when DDS did not take it.
    bool publish(std::string message) const;

    const std::string& topic() const { return topic_; }
    dds_entity_t entity() const { return writer_; }

private:
    dds_entity_t writer_;
    std::string topic_;
};

/// Who a node is.
struct NodeName {
    std::string name_space = "/";
    std::string name = "disparity_ros2";
    bool humble = false;  ///< the graph is told in the way of ROS 2 Humble, whose message of it is another one
};

/// A node of ROS 2: a participant of DDS that other nodes see under its name. One thread makes it and ends it.
class Node {
public:
    /// Throws std::runtime_error with one line when DDS refuses, such as a configuration that is wrong.
    Node(const NodeName& name, const Domain& domain);
    ~Node();
    Node(const Node&) = delete;
    Node& operator=(const Node&) = delete;

    /// Adds a publisher. `topic`: "/name", of ROS; `message`: "package/Name". Throws as the constructor.
    const Publisher& advertise(const std::string& topic, std::string_view message, const Quality& quality);

    /// Tells other nodes the name and the topics: once all are advertised. Throws as the constructor.
    void announce();

    /// Waits until a subscriber of any topic comes or goes, or the time is over. Returns whether one did since the last
    /// call; those that Publisher::readers() has counted meanwhile do not count.
    bool wait(std::chrono::milliseconds most) const;

private:
    std::string graph_message() const;

    NodeName name_;
    dds_entity_t domain_ = 0;
    dds_entity_t participant_ = 0;
    dds_entity_t waitset_ = 0;
    std::vector<std::unique_ptr<Publisher>> publishers_;
};

}  // namespace disparityd::ros2
