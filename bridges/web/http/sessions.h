// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "bridges/web/http/routes.h"

namespace disparityd::web {

/// What becomes of a request for a WebSocket.
struct WebSocketChoice {
    std::shared_ptr<MessageHandler> handler;  ///< nullptr: refused
    std::string protocol;                     ///< the subprotocol that is agreed on
    Response refusal;
};

/// Chooses by the subprotocols that the client offers: the page's, or one of Foxglove's.
WebSocketChoice choose_websocket(const Request& request, const Workplace& workplace, const Access& access);

/// What becomes of a request for the MJPEG stream.
struct StreamChoice {
    std::shared_ptr<MessageHandler> handler;  ///< nullptr: refused
    std::string head;                         ///< of the response
    Response refusal;
};

/// The query says image (default disparity), width (default: as it is), rate (default: all).
StreamChoice choose_stream(const Request& request, const Workplace& workplace, const Access& access);

}  // namespace disparityd::web
