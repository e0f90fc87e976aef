// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "bridges/web/http/routes.h"
#include "clients/json/message_json.h"

namespace disparityd::web {

/// Returns the body as an object; nothing when it is none. A page of another server cannot send this type unasked.
std::optional<json::Json> body_of(const Request& request);

/// Returns the text of a key, "" where there is none.
std::string text_in(const json::Json& body, const char* key);

}  // namespace disparityd::web
