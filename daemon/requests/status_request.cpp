// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/status_request.h"

#include <utility>

namespace disparityd::daemon {

Request status_request(std::function<v1::Status()> status) {
    return {.message = v1::Envelope::kStatusRequest,
            .name = "status_request",
            .word = "status",
            .handle = [status = std::move(status)](const v1::Envelope&, const Requester&, const Reply& reply) {
                reply(answer_of([&](v1::Envelope& answer) { *answer.mutable_status() = status(); }));
            }};
}

}  // namespace disparityd::daemon
