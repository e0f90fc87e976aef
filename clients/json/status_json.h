// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include <nlohmann/json.hpp>

#include "proto/disparity.pb.h"

/// Converts what the daemon tells to JSON, with the keys in the order in which people read them. disparityctl --json
/// and the page show the same. docs/operations.md explains the fields.
namespace disparityd::json {

using Json = nlohmann::ordered_json;

Json to_json(const v1::Status& status);
Json to_json(const v1::RecordStatus& status);
Json to_json(const v1::SelfCalibration& status);
Json to_json(const v1::CameraStatus& camera);
Json to_json(const v1::SensorStatus& sensors);
Json to_json(const v1::CameraControls& controls);

/// Returns 16 hexadecimal digits: JSON's numbers cannot hold 64 bits.
std::string hexadecimal(std::uint64_t id);

/// Returns the JSON as text. Bytes that are not UTF-8 are replaced.
std::string to_text(const Json& json, int indent);

}  // namespace disparityd::json
