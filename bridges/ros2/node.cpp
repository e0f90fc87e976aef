// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros2/node.h"

#include <array>
#include <stdexcept>
#include <utility>

#include "bridges/ros2/cdr_topic.h"
#include "bridges/ros_messages/message_definitions.h"
#include "formats/cdr_writer.h"

namespace disparityd::ros2 {
namespace {

using std::chrono::milliseconds;
using QosPointer = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;

constexpr std::string_view graph_topic = "ros_discovery_info";
constexpr std::string_view graph_message_name = "rmw_dds_common/ParticipantEntitiesInfo";
/// For a network that is busy: images are large.
constexpr dds_duration_t most_blocking = DDS_MSECS(20);

/// Returns what is not an error.
dds_entity_t checked(dds_entity_t result, const std::string& what) {
    if (result < 0) {
        throw std::runtime_error(what + ": DDS says " + dds_strretcode(result) +
                                 "; look at CYCLONEDDS_URI, ROS_DOMAIN_ID and the network's interfaces");
    }
    return result;
}

QosPointer qos_of(const Quality& quality, std::string_view user_data) {
    QosPointer qos(dds_create_qos(), dds_delete_qos);
    dds_qset_reliability(qos.get(), quality.reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                         most_blocking);
    dds_qset_durability(qos.get(), quality.transient_local ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, quality.depth);
    const std::array<dds_data_representation_id_t, 1> representation{DDS_DATA_REPRESENTATION_XCDR1};
    dds_qset_data_representation(qos.get(), representation.size(), representation.data());
    if (!user_data.empty()) {
        dds_qset_userdata(qos.get(), user_data.data(), user_data.size());
    }
    return qos;
}

dds_entity_t make_participant(dds_domainid_t id) {
    // Nodes of ROS know by this that it is one of them.
    constexpr std::string_view enclave = "enclave=/;";
    const QosPointer qos(dds_create_qos(), dds_delete_qos);
    dds_qset_userdata(qos.get(), enclave.data(), enclave.size());
    return checked(dds_create_participant(id, qos.get(), nullptr), "domain " + std::to_string(id));
}

dds_entity_t make_writer(dds_entity_t participant, const std::string& topic_name, std::string_view message,
                         const Quality& quality) {
    const dds_entity_t topic =
        checked(create_cdr_topic(participant, topic_name, ros::dds_type_name(message)), "topic " + topic_name);
    const std::string type = "typehash=" + std::string(ros::type_hash(message)) + ";";
    const QosPointer qos = qos_of(quality, type);
    return checked(dds_create_writer(participant, topic, qos.get(), nullptr), "topic " + topic_name);
}

/// A Gid has 16 bytes since Iron, 24 in Humble, where the last ones are 0.
void write_gid(formats::CdrWriter& cdr, dds_entity_t entity, bool humble) {
    dds_guid_t guid{};
    dds_get_guid(entity, &guid);
    for (const std::uint8_t byte : guid.v) {
        cdr.u8(byte);
    }
    for (std::size_t i = sizeof guid.v; humble && i < 24; ++i) {
        cdr.u8(0);
    }
}

}  // namespace

std::uint32_t Publisher::readers() const {
    dds_publication_matched_status_t status{};
    dds_get_publication_matched_status(writer_, &status);
    return status.current_count;
}

bool Publisher::publish(std::string message) const {
    return write_cdr(writer_, std::move(message)) == DDS_RETCODE_OK;
}

Node::Node(const NodeName& name, const Domain& domain) : name_(name) {
    domain_ = checked(dds_create_domain(domain.id, cyclone_configuration(domain).c_str()),
                      "domain " + std::to_string(domain.id));
    try {
        participant_ = make_participant(domain.id);
        waitset_ = checked(dds_create_waitset(participant_), "a set of conditions");
    } catch (...) {
        dds_delete(domain_);
        throw;
    }
}

Node::~Node() {
    dds_delete(domain_);  // with all that is in it
}

const Publisher& Node::advertise(const std::string& topic, std::string_view message, const Quality& quality) {
    const dds_entity_t writer = make_writer(participant_, "rt" + topic, message, quality);
    dds_set_status_mask(writer, DDS_PUBLICATION_MATCHED_STATUS);
    checked(dds_waitset_attach(waitset_, writer, 0), "topic " + topic);
    publishers_.push_back(std::make_unique<Publisher>(writer, topic));
    return *publishers_.back();
}

void Node::announce() {
    const dds_entity_t writer = make_writer(participant_, std::string(graph_topic), graph_message_name,
                                            {.reliable = true, .transient_local = true, .depth = 1});
    if (const dds_return_t result = write_cdr(writer, graph_message()); result != DDS_RETCODE_OK) {
        checked(result, std::string(graph_topic));
    }
}

std::string Node::graph_message() const {
    formats::CdrWriter cdr(64 + 32 * publishers_.size());
    write_gid(cdr, participant_, name_.humble);
    cdr.length(1).text(name_.name_space).text(name_.name);
    cdr.length(0);  // it subscribes to nothing
    cdr.length(publishers_.size());
    for (const auto& publisher : publishers_) {
        write_gid(cdr, publisher->entity(), name_.humble);
    }
    return cdr.take();
}

bool Node::wait(milliseconds most) const {
    const bool changed = dds_waitset_wait(waitset_, nullptr, 0, DDS_MSECS(most.count())) > 0;
    for (const auto& publisher : publishers_) {
        publisher->readers();  // what nobody has looked at wakes the next call at once
    }
    return changed;
}

}  // namespace disparityd::ros2
