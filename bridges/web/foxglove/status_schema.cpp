// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/foxglove/status_schema.h"

#include "clients/json/message_json.h"
#include "proto/disparity.pb.h"

namespace disparityd::foxglove {

std::string status_schema() {
    json::Json schema = json::schema_of(*v1::Status::descriptor());
    schema["title"] = "disparityd.Status";
    return schema.dump();
}

}  // namespace disparityd::foxglove
