// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/foxglove/status_schema.h"

#include "clients/json/status_json.h"

namespace disparityd::foxglove {
namespace {

using json::Json;

/// Returns a status that has each field and one element of each list, so that its JSON shows all that there is.
v1::Status full_status() {
    v1::Status status;
    status.add_steps();
    status.add_clients();
    status.add_products(v1::DISPARITY);
    status.add_notices();
    status.mutable_self_calibration();
    status.mutable_camera();
    status.mutable_sensors();
    return status;
}

Json schema_of(const Json& value) {
    switch (value.type()) {
        case Json::value_t::object: {
            Json properties = Json::object();
            for (const auto& [key, field] : value.items()) {
                properties[key] = schema_of(field);
            }
            return {{"type", "object"}, {"properties", properties}};
        }
        case Json::value_t::array: return {{"type", "array"}, {"items", schema_of(value.at(0))}};
        case Json::value_t::string: return {{"type", "string"}};
        case Json::value_t::boolean: return {{"type", "boolean"}};
        default:  // a viewer that plots makes no difference between whole numbers and others
            return {{"type", "number"}};
    }
}

}  // namespace

std::string status_schema() {
    Json schema = schema_of(json::to_json(full_status()));
    schema["title"] = "disparityd.Status";
    return schema.dump();
}

}  // namespace disparityd::foxglove
