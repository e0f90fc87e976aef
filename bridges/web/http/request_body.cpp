// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/http/request_body.h"

#include <utility>

namespace disparityd::web {

using json::Json;

std::optional<Json> body_of(const Request& request) {
    if (!request[boost::beast::http::field::content_type].starts_with("application/json")) {
        return std::nullopt;
    }
    Json body = Json::parse(request.body(), nullptr, false);
    return body.is_object() ? std::optional<Json>(std::move(body)) : std::nullopt;
}

std::string text_in(const Json& body, const char* key) {
    const auto found = body.find(key);
    return found != body.end() && found->is_string() ? found->get<std::string>() : std::string();
}

}  // namespace disparityd::web
