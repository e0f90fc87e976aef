// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <dds/dds.h>

/// Topics of Cyclone DDS whose messages are bytes that somebody else has encoded: nothing is generated for their types,
/// and nothing is copied until the system sends it.
namespace disparityd::ros2 {

/// Creates a topic without keys of the type `type_name`; it ends with the participant. Returns what dds_create_topic()
/// does: a negative code for an error.
dds_entity_t create_cdr_topic(dds_entity_t participant, const std::string& name, const std::string& type_name);

/// Writes a message, CDR of version 1 with its header of 4 bytes, to a writer of a CDR topic; any thread. DDS keeps it
/// until every reader has it or newer ones take its place. Returns what dds_write() does.
dds_return_t write_cdr(dds_entity_t writer, std::string message);

}  // namespace disparityd::ros2
