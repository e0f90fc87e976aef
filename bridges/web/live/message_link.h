// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace disparityd::web {

/// A part of a message; several connections may send the same bytes.
using Bytes = std::shared_ptr<const std::string>;

/// Sends messages to one connection: over a WebSocket, or as the parts of a multipart stream. All calls come from the
/// network's thread.
class MessageLink {
public:
    virtual ~MessageLink() = default;
    virtual void send_text(std::string text) = 0;
    /// Sends the parts as one message.
    virtual void send_binary(std::vector<Bytes> parts) = 0;
    /// Whether a binary message is on its way out, or too much waits in this program: what is sent now would wait, and
    /// be older when it arrives.
    virtual bool busy() const = 0;
    /// Asks the peer to say that it has read what was sent before: the handler's on_answer() is told `mark` then. Does
    /// nothing where the protocol has no answer.
    virtual void ask_for_answer(std::string mark) = 0;
};

/// Is told what a connection receives. It is kept alive by its connection.
class MessageHandler {
public:
    virtual ~MessageHandler() = default;
    /// The link lives at least as long as the handler is told things.
    virtual void on_open(MessageLink& link) = 0;
    virtual void on_text(std::string_view text) = 0;
    virtual void on_binary() = 0;                         ///< a message that is no text came; its bytes are left out
    virtual void on_sent() = 0;                           ///< a message is out
    virtual void on_answer(std::string_view /*mark*/) {}  ///< the peer has read all up to ask_for_answer(mark)
    virtual void on_closed() = 0;                         ///< the link must not be used any more
    /// Whether the peer has asked for nothing that comes by itself: its place may be given to another.
    virtual bool wants_nothing() const = 0;
};

}  // namespace disparityd::web
