// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>

namespace disparityd::daemon {

/// A handler that a session passes to Boost.Asio. Calls `function` with the session and the arguments of Asio. An
/// exception of `function` closes that session only. Asio destroys a handler uncalled when it runs out of memory;
/// nothing would resume the session then, so the destructor closes it.
template <typename Session, typename Function>
class ClientHandler {
public:
    ClientHandler(std::shared_ptr<Session> session, Function function)
        : session_(std::move(session)), function_(std::move(function)) {}
    ClientHandler(ClientHandler&&) noexcept = default;
    ClientHandler& operator=(ClientHandler&&) = delete;
    ClientHandler(const ClientHandler&) = delete;
    ClientHandler& operator=(const ClientHandler&) = delete;

    ~ClientHandler() {
        if (session_) {
            session_->handler_lost();
        }
    }

    template <typename... Arguments>
    void operator()(const Arguments&... arguments) {
        const auto session = std::move(session_);
        session->guarded([&] { function_(*session, arguments...); });
    }

private:
    std::shared_ptr<Session> session_;  ///< null after the call or a move
    Function function_;
};

}  // namespace disparityd::daemon
