// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "bridges/web/http/routes.h"
#include "bridges/web/live/live_session.h"

namespace disparityd::web {

/// What becomes of a request for a WebSocket.
struct WebSocketChoice {
    std::shared_ptr<MessageHandler> handler;  ///< nullptr: refused
    std::string protocol;                     ///< the subprotocol that is agreed on
    Right right = Right::none;                ///< the visitor's
    Response refusal;
};

/// Chooses by the subprotocols that the client offers: the page's, or one of Foxglove's. `peer`: the visitor's address.
WebSocketChoice choose_websocket(const Request& request, const Workplace& workplace, const Access& access,
                                 const std::string& peer);

/// What becomes of a request for the MJPEG stream.
struct StreamChoice {
    std::shared_ptr<MessageHandler> handler;  ///< nullptr: refused
    std::string head;                         ///< of the response
    Right right = Right::none;                ///< the visitor's
    Response refusal;
};

/// The query says image (default disparity), width (default: as it is), rate (default: all). The head tells the rate.
StreamChoice choose_stream(const Request& request, const Workplace& workplace, const Access& access,
                           const std::string& peer);

}  // namespace disparityd::web
